//! Result files in other formats: every value must come back to the last bit.

#[expect(dead_code, reason = "what files must hold is another test's matter")]
mod recorded;
mod written;

use freeplay::export::{Format, TableName, export};
use freeplay::record::ResultFile;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use recorded::Recorded;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use written::{Run, alone, freeplay};

const TABLES: [TableName; 4] =
    [TableName::Samples, TableName::Events, TableName::Contacts, TableName::Peaks];

/// A table as a format gives it back: names, and rows of text or numbers.
struct Table {
    names: Vec<String>,
    rows: Vec<Vec<Cell>>,
}

#[derive(Debug, Clone, PartialEq)]
enum Cell {
    /// Bits of a double.
    Number(u64),
    Word(String),
}

fn number(value: f64) -> Cell {
    Cell::Number(if value.is_nan() { f64::NAN } else { value }.to_bits())
}

/// Kinds of event by their numbers; two are not used.
const KINDS: [&str; 8] = [
    "contact_begins",
    "contact_ends",
    "friction_kink",
    "tension_begins_or_ends",
    "",
    "",
    "course_changes",
    "singular_position",
];

/// What a table must hold, from the datasets one by one.
fn expected(file: &ResultFile, table: TableName) -> Table {
    let names: Vec<String> = match table {
        TableName::Samples => file.columns(),
        TableName::Events => {
            words("event_time event_clearance event_kind event_rate event_owner event_owner_index")
        }
        TableName::Contacts => words(
            "contact_clearance contact_begin contact_end contact_impact_rate \
             contact_peak_penetration contact_peak_penetration_time contact_peak_force \
             contact_peak_time contact_dissipated",
        ),
        TableName::Peaks => words("peak_time peak_clearance peak_force"),
    };
    let of = |words: &[&str], value: f64| Cell::Word(words[value as usize].to_owned());
    let columns: Vec<Vec<Cell>> = names
        .iter()
        .map(|name| {
            let values = file.column(name).unwrap().into_iter();
            match name.as_str() {
                "event_kind" => values.map(|value| of(&KINDS, value)).collect(),
                "event_owner" => values
                    .map(|value| of(&["clearance", "drive", "load", "joint"], value))
                    .collect(),
                name if name.ends_with("_clearance") => values
                    .map(|value| match value {
                        -1.0 => Cell::Word(String::new()),
                        value => Cell::Word(file.clearances()[value as usize].clone()),
                    })
                    .collect(),
                _ => values.map(number).collect(),
            }
        })
        .collect();
    let rows = columns[0].len();
    let row = |k: usize| columns.iter().map(|column| column[k].clone()).collect();
    Table { names, rows: (0..rows).map(row).collect() }
}

fn words(text: &str) -> Vec<String> {
    text.split_whitespace().map(str::to_owned).collect()
}

fn read_csv(path: &Path) -> Table {
    let mut reader = csv::Reader::from_path(path).unwrap();
    let names = reader.headers().unwrap().iter().map(str::to_owned).collect();
    let cell = |field: &str| match field.parse() {
        Ok(value) => number(value),
        Err(_) => Cell::Word(field.to_owned()),
    };
    let rows = reader.records().map(|record| record.unwrap().iter().map(cell).collect());
    Table { names, rows: rows.collect() }
}

fn read_parquet(path: &Path) -> Table {
    let reader = SerializedFileReader::new(std::fs::File::open(path).unwrap()).unwrap();
    let schema = reader.metadata().file_metadata().schema_descr();
    let names = schema.columns().iter().map(|column| column.name().to_owned()).collect();
    let cell = |field: &Field| match field {
        Field::Double(value) => number(*value),
        Field::Byte(value) => number(f64::from(*value)),
        Field::Int(value) => number(f64::from(*value)),
        Field::Str(word) => Cell::Word(word.clone()),
        other => panic!("no column is a {other:?}"),
    };
    let rows = reader.get_row_iter(None).unwrap();
    let rows = rows.map(|row| row.unwrap().get_column_iter().map(|(_, f)| cell(f)).collect());
    Table { names, rows: rows.collect() }
}

/// Files of arbitrary numbers: more rows than are read at a time; with events; one row; none.
fn files(folder: &Path) -> Vec<PathBuf> {
    [
        Recorded::new(&[], 66_000, 0),
        Recorded::new(&["A", "B"], 50, 40),
        Recorded::new(&["A"], 1, 1),
        Recorded::new(&["A"], 0, 0),
    ]
    .iter()
    .enumerate()
    .map(|(k, run)| {
        let _alone = alone();
        run.write(&folder.join(format!("{k}.h5")), false)
    })
    .collect()
}

#[test]
fn every_value_comes_back_to_the_last_bit_from_csv_and_from_parquet() {
    let folder = tempfile::tempdir().unwrap();
    for path in files(folder.path()) {
        let file = ResultFile::open(&path).unwrap();
        for table in TABLES {
            let expected = expected(&file, table);
            for (format, read) in
                [(Format::Csv, read_csv as fn(&Path) -> Table), (Format::Parquet, read_parquet)]
            {
                let output = folder.path().join("table");
                let written = export(&file, format, table, &output, true).unwrap();
                let found = read(&output);
                let told = format!("{format:?} of {table:?} of {}", path.display());
                assert_eq!(found.names, expected.names, "{told}");
                assert_eq!(written.rows, expected.rows.len(), "{told}");
                assert_eq!(written.columns, expected.names.len(), "{told}");
                assert!(found.rows == expected.rows, "{told} gives other values");
            }
        }
    }
}

#[test]
fn parquet_tells_units_and_descriptions_by_column_and_the_case() {
    let folder = tempfile::tempdir().unwrap();
    let path = &files(folder.path())[1];
    let file = ResultFile::open(path).unwrap();
    let output = folder.path().join("run.parquet");
    export(&file, Format::Parquet, TableName::Samples, &output, false).unwrap();
    let reader = SerializedFileReader::new(std::fs::File::open(&output).unwrap()).unwrap();
    let metadata = reader.metadata().file_metadata().key_value_metadata().unwrap();
    let text = |key: &str| {
        let found = metadata.iter().find(|entry| entry.key == key);
        found.unwrap_or_else(|| panic!("no {key}")).value.clone().unwrap()
    };
    let units: serde_json::Value = serde_json::from_str(&text("units")).unwrap();
    for (column, unit) in
        [("time", "s"), ("angle.coupler", "rad"), ("normal_force.B", "N"), ("in_contact.A", "1")]
    {
        assert_eq!(units[column], unit, "{column}");
    }
    assert_eq!(units.as_object().unwrap().len(), file.columns().len());
    let pandas: serde_json::Value = serde_json::from_str(&text("PANDAS_ATTRS")).unwrap();
    assert_eq!(pandas["units"], units);
    assert_eq!(Some(text("case_toml").as_str()), file.text("case_toml"));
}

#[test]
fn an_output_that_is_there_stays_unless_forced() {
    let folder = tempfile::tempdir().unwrap();
    let input = files(folder.path())[1].to_str().unwrap().to_owned();
    let output = folder.path().join("run.csv");
    let out = output.to_str().unwrap();
    let ask =
        |more: &[&str]| freeplay(&[&["export", &input, "--to", "csv", "-o", out], more].concat());
    let made = ask(&[]);
    assert!(made.status.success() && made.stderr.is_empty());
    let said = String::from_utf8(made.stdout).unwrap();
    assert!(
        said.starts_with(out) && said.contains("50 rows") && said.lines().count() == 1,
        "{said}"
    );
    let samples = std::fs::read(&output).unwrap();
    let refused = ask(&["--table", "events"]);
    assert_eq!(refused.status.code(), Some(3));
    assert!(String::from_utf8(refused.stderr).unwrap().contains("--force"));
    assert_eq!(std::fs::read(&output).unwrap(), samples);
    assert!(ask(&["--table", "events", "--force"]).status.success());
    let events = std::fs::read_to_string(&output).unwrap();
    assert!(events.starts_with("event_time,") && events.lines().count() == 41);
    let left = std::fs::read_dir(folder.path()).unwrap().count();
    assert_eq!(left, 5, "four result files and the output, nothing temporary");
}

#[test]
fn wrong_inputs_and_outputs_end_with_their_exit_codes() {
    let folder = tempfile::tempdir().unwrap();
    let input = files(folder.path())[1].to_str().unwrap().to_owned();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    std::fs::write(at("text.h5"), "no HDF5").unwrap();
    for (file, to, output, code, words) in [
        (at("text.h5"), "csv", at("a.csv"), 2, "not an HDF5 file"),
        (at("missing.h5"), "parquet", at("a.parquet"), 2, "cannot open"),
        (input.clone(), "csv", at("no/folder.csv"), 3, "no folder"),
        (input.clone(), "openmbv", at("scene.xml"), 2, ".ombvx"),
        // arbitrary numbers come with no case that can be drawn
        (input.clone(), "openmbv", at("scene.ombvx"), 2, "cannot be drawn"),
        (input, "xlsx", at("a.xlsx"), 2, "possible values"),
    ] {
        let refused = freeplay(&["export", &file, "--to", to, "-o", &output]);
        let told = String::from_utf8(refused.stderr).unwrap();
        assert_eq!(refused.status.code(), Some(code), "{told}");
        assert!(told.contains(words), "{told}");
        assert!(!Path::new(&output).exists(), "{output}");
    }
}

/// Elements of an XML text, each with its depth and its attribute `name`; every element is closed.
fn elements(xml: &str) -> Vec<(usize, String, Option<String>)> {
    let (mut open, mut found) = (Vec::new(), Vec::new());
    for tag in xml.split('<').skip(1).filter(|tag| !tag.starts_with('?')) {
        let (tag, _) = tag.split_once('>').unwrap();
        if let Some(closed) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(closed.to_owned()));
            continue;
        }
        let element = tag.split(' ').next().unwrap().to_owned();
        let name = tag.split_once("name=\"").map(|(_, rest)| rest.split('"').next().unwrap());
        found.push((open.len(), element.clone(), name.map(str::to_owned)));
        open.push(element);
    }
    assert!(open.is_empty(), "{open:?} are never closed");
    found
}

#[test]
fn the_scene_for_openmbv_moves_as_the_mechanism_does() {
    let run = Run::of("four-bar-c", &["run.duration=0.002"]);
    let file = run.file();
    let output = run.beside("scene.ombvx");
    {
        let _alone = alone();
        export(&file, Format::OpenMbv, TableName::Samples, &output, false).unwrap();
    }
    let scene = elements(&std::fs::read_to_string(&output).unwrap());
    let things: BTreeSet<(String, String)> = scene
        .iter()
        .filter(|(depth, element, _)| *depth == 2 && element != "Group")
        .map(|(_, element, name)| (element.clone(), name.clone().unwrap()))
        .collect();
    let motion = hdf5::File::open(run.beside("scene.ombvh5")).unwrap();
    let of = |group: &str, name: &str| {
        let data = motion.dataset(&format!("{group}/{name}/data")).unwrap();
        assert!(data.is_resizable() && data.is_chunked());
        data.read_2d::<f64>().unwrap()
    };
    let mut expected = BTreeSet::new();
    for name in ["ground", "crank", "coupler", "follower"] {
        expected.insert(("CompoundRigidBody".to_owned(), name.to_owned()));
        let data = of("bodies", name);
        assert_eq!(data.column(0).to_vec(), file.times().unwrap());
        if name != "ground" {
            for (place, column) in [(1, "position_x"), (2, "position_y"), (6, "angle")] {
                let column = file.column(&format!("{column}.{name}")).unwrap();
                assert_eq!(data.column(place).to_vec(), column);
            }
        }
    }
    for name in ["A0", "A", "B", "B0"] {
        expected.insert(("Arrow".to_owned(), name.to_owned()));
        let force = file.column(&format!("joint_force_y.{name}")).unwrap();
        assert_eq!(of("forces", name).column(5).to_vec(), force);
    }
    assert_eq!(things, expected);
    // the tip in A is at the journal's centre: the clearance vector away from the crank's end
    let (tip, crank) = (of("forces", "A"), of("bodies", "crank"));
    let eccentricity = file.column("eccentricity.A").unwrap();
    for (row, eccentricity) in eccentricity.iter().enumerate() {
        let (sin, cos) = crank[[row, 6]].sin_cos();
        let bearing = [crank[[row, 1]] + 0.015 * cos, crank[[row, 2]] + 0.015 * sin];
        let away = (tip[[row, 1]] - bearing[0]).hypot(tip[[row, 2]] - bearing[1]);
        assert!((away - eccentricity).abs() < 1e-15, "row {row}: {away} and {eccentricity}");
    }
}

/// The contours (m) of a shape in a scene.
fn contours(xml: &str, shape: &str) -> Vec<Vec<[f64; 2]>> {
    let (_, from) = xml.split_once(&format!("<Extrusion name=\"{shape}\">")).unwrap();
    let (shape, _) = from.split_once("</Extrusion>").unwrap();
    let corner = |text: &str| {
        let mut numbers = text.split(',').map(|number| number.trim().parse::<f64>().unwrap());
        [numbers.next().unwrap(), numbers.next().unwrap()]
    };
    let contours = shape.split("<contour>[").skip(1);
    contours.map(|text| text.split(']').next().unwrap().split(';').map(corner).collect()).collect()
}

#[test]
fn the_scene_for_openmbv_has_walls_blocks_racks_pinions_and_springs() {
    let guided = Run::of("block-in-guide", &["run.sample_interval=1e-4"]);
    let output = guided.beside("scene.ombvx");
    let written = |file: &ResultFile, output: &Path| {
        let _alone = alone();
        export(file, Format::OpenMbv, TableName::Samples, output, false).unwrap();
    };
    written(&guided.file(), &output);
    let scene = std::fs::read_to_string(&output).unwrap();
    let motion = hdf5::File::open(guided.beside("scene.ombvh5")).unwrap();
    let motion = motion.dataset("bodies/block/data").unwrap().read_2d::<f64>().unwrap();
    // the block comes as deep into the faces of the walls as its corners do
    let faces = [("wall_1_slide", 1.0), ("wall_2_slide", -1.0)].map(|(wall, side)| {
        let corners = contours(&scene, wall).remove(0);
        corners.iter().map(|[_, y]| side * y).fold(f64::INFINITY, f64::min)
    });
    assert_eq!(faces, [0.0255; 2]);
    let block = contours(&scene, "block_slide").remove(0);
    let rises = motion.rows().into_iter().flat_map(|row| {
        let (sin, cos) = row[6].sin_cos();
        block.iter().map(move |[x, y]| (row[2] + sin * x + cos * y).abs()).collect::<Vec<_>>()
    });
    let highest = rises.fold(0.0, f64::max);
    let deepest =
        (1..=4).flat_map(|k| guided.file().column(&format!("penetration.slide_{k}")).unwrap());
    let deepest = deepest.fold(f64::NEG_INFINITY, f64::max);
    assert!((highest - 0.0255 - deepest).abs() < 1e-9, "{highest} {deepest}");

    let run = Run::of("../tests/kinds/loads", &["run.duration=0.1"]);
    let file = run.file();
    let output = run.beside("scene.ombvx");
    written(&file, &output);
    let scene = std::fs::read_to_string(&output).unwrap();
    let things = elements(&scene);
    assert!(things.iter().any(|(depth, element, name)| {
        (*depth, element.as_str(), name.as_deref()) == (2, "CoilSpring", Some("coil"))
    }));
    // its ends are at the points of the barrel and the wheel
    let motion = hdf5::File::open(run.beside("scene.ombvh5")).unwrap();
    let coil = motion.dataset("springs/coil/data").unwrap().read_2d::<f64>().unwrap();
    let column = |name: &str| file.column(name).unwrap();
    let (x, y, angle) =
        (column("position_x.barrel"), column("position_y.barrel"), column("angle.barrel"));
    for row in 0..coil.nrows() {
        let (sin, cos) = angle[row].sin_cos();
        let end = [x[row] + 0.05 * cos - 0.01 * sin, y[row] + 0.05 * sin + 0.01 * cos];
        assert!((coil[[row, 1]] - end[0]).hypot(coil[[row, 2]] - end[1]) < 1e-15);
        assert_eq!(coil[[row, 4]], column("position_x.wheel")[row]);
        assert_eq!(coil[[row, 5]], column("position_y.wheel")[row]);
    }
    // the pinion touches its rack: to the right of the axis, for its radius is negative
    let across = |[x, y]: &[f64; 2]| (2.0 * (y + 0.3) - (x - 0.5)) / 5.0_f64.sqrt();
    let rack = contours(&scene, "rack_teeth").remove(0);
    let face = rack.iter().map(across).fold(f64::NEG_INFINITY, f64::max);
    assert!((face + 0.08).abs() < 1e-8, "{face}");
    let pinion = contours(&scene, "pinion_teeth").remove(0);
    assert!(pinion.iter().all(|[x, y]| (x.hypot(*y) - 0.08).abs() < 1e-8));
    // the block of the piston turns with the piston
    let block = contours(&scene, "block_guide").remove(0);
    let along = [block[1][0] - block[0][0], block[1][1] - block[0][1]];
    let turned = along[1].atan2(along[0]);
    assert!((turned - (1.0_f64.atan2(2.0) - 0.3)).abs() < 1e-6, "{turned}");
}

#[test]
fn the_scene_for_openmbv_has_gear_wheels_loads_and_torsion_springs() {
    let run = Run::of("planetary-gear", &["run.duration=0.1", "run.sample_interval=0.01"]);
    let output = run.beside("scene.ombvx");
    {
        let _alone = alone();
        export(&run.file(), Format::OpenMbv, TableName::Samples, &output, false).unwrap();
    }
    let scene = std::fs::read_to_string(&output).unwrap();
    let motion = hdf5::File::open(run.beside("scene.ombvh5")).unwrap();
    let of =
        |name: &str| motion.dataset(&format!("{name}/data")).unwrap().read_2d::<f64>().unwrap();
    // 20, 20 and 60 teeth about axes 0.04 m apart: sun and planet outside, the ring inside
    let bodies = scene.split("<CompoundRigidBody").skip(1);
    let radius = |contour: &[[f64; 2]]| contour[0][0].hypot(contour[0][1]);
    for (body, ring, pitch) in bodies
        .skip(1)
        .zip([false, false, false, true])
        .zip([0.02, 0.0, 0.02, 0.06])
        .map(|((b, r), p)| (b, r, p))
    {
        let gear = ["gear_outer", "gear_inner"].into_iter().find(|gear| body.contains(gear));
        assert_eq!(gear.is_some(), pitch > 0.0);
        let Some(gear) = gear else { continue };
        let both = contours(body, gear);
        let (outer, inner) = (radius(&both[0]), radius(&both[1]));
        assert!(outer > inner && inner > 0.5 * pitch);
        let at_pitch = if ring { inner } else { outer };
        assert!((at_pitch - pitch).abs() < 1e-8, "{gear}: {at_pitch}");
    }
    // the brake turns the carrier about z, and has two heads
    let things = elements(&scene);
    assert!(things.iter().any(|(depth, element, name)| {
        (*depth, element.as_str(), name.as_deref()) == (2, "Arrow", Some("brake"))
    }));
    assert_eq!(scene.matches("'toDoubleHead'").count(), 1);
    let (brake, carrier) = (of("loads/brake"), of("bodies/carrier"));
    assert_eq!(brake.column(1), carrier.column(1));
    assert!(brake.rows().into_iter().all(|row| row[4] == 0.0 && row[5] == 0.0 && row[6] > 0.0));
    // the torsion spring stands on the ring
    assert!(
        scene.split("<CompoundRigidBody name=\"ring\">").nth(1).unwrap().contains("\"coil_coil\"")
    );

    let run = Run::of("slider-crank-gas", &["run.duration=0.001"]);
    let output = run.beside("scene.ombvx");
    {
        let _alone = alone();
        export(&run.file(), Format::OpenMbv, TableName::Samples, &output, false).unwrap();
    }
    let motion = hdf5::File::open(run.beside("scene.ombvh5")).unwrap();
    let loads = motion.group("loads").unwrap().member_names().unwrap();
    let gas =
        motion.dataset(&format!("loads/{}/data", loads[0])).unwrap().read_2d::<f64>().unwrap();
    // along the guide, tip at the piston
    let slider = motion.dataset("bodies/slider/data").unwrap().read_2d::<f64>().unwrap();
    assert_eq!(gas.column(1), slider.column(1));
    assert!(gas.rows().into_iter().all(|row| row[4] != 0.0 && row[5] == 0.0 && row[6] == 0.0));
}

#[test]
fn adaptive_samples_make_an_even_film() {
    let run = Run::of("four-bar-a", &["run.duration=0.001", "run.sampling=adaptive"]);
    let file = run.file();
    assert!(file.times().unwrap().len() > 101, "adaptive sampling adds to the grid");
    let _alone = alone();
    let output = run.beside("scene.ombvx");
    let written = export(&file, Format::OpenMbv, TableName::Samples, &output, false).unwrap();
    assert_eq!(written.rows, 101);
    let motion = hdf5::File::open(run.beside("scene.ombvh5")).unwrap();
    let times = motion.dataset("bodies/crank/data").unwrap().read_2d::<f64>().unwrap();
    for (k, time) in times.column(0).iter().enumerate() {
        assert!((time - 1e-5 * k as f64).abs() < 1e-18, "row {k} at {time} s");
    }
}
