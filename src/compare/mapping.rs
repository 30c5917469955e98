//! Which column of another program is which of ours.
//!
//! `--map theirs=ours` settles it. Else names are guessed where that is safe: a name must say both
//! what it is and of which body, joint or drive (`angle_coupler`, `coupler.omega`), the second only
//! where there is but one; no two of their columns may mean the same; a unit must fit. Signs are
//! not guessed.

use super::Error;
use super::foreign::{ForeignColumn, ForeignTable};
use super::quantity::{Column, Parts};
use super::unit::{Unit, named};
use crate::model::did_you_mean;
use std::collections::BTreeMap;
use std::str::FromStr;

/// A column of theirs and what it is of ours, as the command line has it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Map {
    /// Their name, a unit behind it where their file does not tell it: `phi3[deg]`.
    pub theirs: String,
    /// Ours, `angle.coupler`; `time` for the time.
    pub ours: String,
}

/// A text is not `theirs=ours`.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0:?} is not THEIRS=OURS, as in phi3=angle.coupler")]
pub struct NotAMap(String);

impl FromStr for Map {
    type Err = NotAMap;

    fn from_str(text: &str) -> Result<Map, NotAMap> {
        // ours never holds an equals sign
        let (theirs, ours) = text.rsplit_once('=').ok_or_else(|| NotAMap(text.to_owned()))?;
        let (theirs, ours) = (theirs.trim().to_owned(), ours.trim().to_owned());
        if theirs.is_empty() || ours.is_empty() {
            return Err(NotAMap(text.to_owned()));
        }
        Ok(Map { theirs, ours })
    }
}

/// How a mapping came about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum How {
    /// By `--map`.
    Given,
    /// The names are the same but for the case of letters.
    SameName,
    /// Guessed from the name.
    Guessed,
}

/// A column of theirs that is one of ours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mapped {
    /// Index of their column.
    pub theirs: usize,
    /// Ours.
    pub ours: Column,
    /// How that is known.
    pub how: How,
    /// Their unit; `None`: that of ours.
    pub unit: Option<Unit>,
}

/// What became of their columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Mapping {
    /// Index of their time.
    pub time: usize,
    /// Its unit; `None`: seconds.
    pub time_unit: Option<Unit>,
    /// The columns that are compared, in the order of ours.
    pub columns: Vec<Mapped>,
    /// Indices of the columns that are not.
    pub unused: Vec<usize>,
    /// What could not be guessed though it was near.
    pub notes: Vec<String>,
}

impl Mapping {
    /// Maps a table onto the columns of a mechanism that are compared.
    ///
    /// # Errors
    /// A map names what is not there or what does not fit; there is no time; nothing is in common.
    pub fn new(
        table: &ForeignTable,
        parts: &Parts,
        compared: &[Column],
        maps: &[Map],
    ) -> Result<Mapping, Error> {
        let given = Given::read(table, parts, compared, maps)?;
        let Some((time, time_unit)) = given.time.or_else(|| {
            let time = table.usual_time()?;
            Some((time, table.columns[time].named().unit))
        }) else {
            return Err(Error::NoTime { path: table.path.clone(), columns: table.names() });
        };
        let mut guesses = Guesses::new(table, parts, compared);
        guesses.drop_settled(&given, time);
        let mut columns = given.columns;
        columns.extend(guesses.certain());
        columns.sort_by_key(|mapped| compared.iter().position(|column| *column == mapped.ours));
        if columns.is_empty() {
            return Err(Error::NothingInCommon {
                path: table.path.clone(),
                columns: table.names(),
                ours: parts.names_of(compared),
                hints: guesses.hints(table, parts, compared),
            });
        }
        let used =
            |index: &usize| *index == time || columns.iter().any(|mapped| mapped.theirs == *index);
        let unused = (0..table.columns.len()).filter(|index| !used(index)).collect();
        Ok(Mapping { time, time_unit, columns, unused, notes: guesses.doubts(table, parts) })
    }
}

impl Mapping {
    /// Leaves out what is none of these columns.
    pub fn keep(&mut self, columns: &[Column]) {
        let (kept, left): (Vec<Mapped>, Vec<Mapped>) =
            self.columns.drain(..).partition(|mapped| columns.contains(&mapped.ours));
        self.columns = kept;
        self.unused.extend(left.iter().map(|mapped| mapped.theirs));
        self.unused.sort_unstable();
    }
}

/// What the command line settles.
#[derive(Debug, Default)]
struct Given {
    time: Option<(usize, Option<Unit>)>,
    columns: Vec<Mapped>,
}

impl Given {
    fn read(
        table: &ForeignTable,
        parts: &Parts,
        compared: &[Column],
        maps: &[Map],
    ) -> Result<Given, Error> {
        let mut given = Given::default();
        for map in maps {
            let (theirs, unit) = find_theirs(table, map)?;
            let twice = || Error::MappedTwice { ours: map.ours.clone() };
            if map.ours == "time" {
                check_unit(table, theirs, unit, "s", &map.ours)?;
                if given.time.replace((theirs, unit)).is_some() {
                    return Err(twice());
                }
                continue;
            }
            let ours = find_ours(parts, compared, &map.ours)?;
            check_unit(table, theirs, unit, ours.dataset.unit, &map.ours)?;
            if given.columns.iter().any(|mapped| mapped.ours == ours) {
                return Err(twice());
            }
            given.columns.push(Mapped { theirs, ours, how: How::Given, unit });
        }
        Ok(given)
    }
}

/// Their column that a map names, and its unit.
fn find_theirs(table: &ForeignTable, map: &Map) -> Result<(usize, Option<Unit>), Error> {
    let find = |is: &dyn Fn(&ForeignColumn) -> bool| {
        let mut found = (0..table.columns.len()).filter(|index| is(&table.columns[*index]));
        found.next().filter(|_| found.next().is_none())
    };
    if let Some(index) = find(&|column| column.name == map.theirs) {
        return Ok((index, table.columns[index].named().unit));
    }
    let wanted = named(&map.theirs);
    let bare = find(&|column| column.name == wanted.name)
        .or_else(|| find(&|column| column.named().name == wanted.name));
    match (bare, wanted.unknown) {
        (Some(_), Some(unit)) => {
            Err(Error::UnknownUnit { column: map.theirs.clone(), unit: unit.to_owned() })
        }
        (Some(index), None) => {
            Ok((index, wanted.unit.or_else(|| table.columns[index].named().unit)))
        }
        (None, _) => {
            let names = table.columns.iter().map(|column| column.name.as_str());
            Err(Error::NoSuchColumn {
                path: table.path.clone(),
                column: map.theirs.clone(),
                hint: did_you_mean(&map.theirs, names),
                columns: table.names(),
            })
        }
    }
}

/// Our column that a map names.
fn find_ours(parts: &Parts, compared: &[Column], name: &str) -> Result<Column, Error> {
    let columns = parts.columns();
    let names: Vec<String> = columns.iter().map(|column| parts.name(column)).collect();
    let Some(index) = names.iter().position(|known| known == name) else {
        let known = names.iter().map(String::as_str).chain(["time"]);
        return Err(Error::NotOurs { name: name.to_owned(), hint: did_you_mean(name, known) });
    };
    let column = columns[index];
    match (compared.contains(&column), column.quantity()) {
        (true, _) => Ok(column),
        (false, Some(_)) => Err(Error::NeedsForces { name: name.to_owned() }),
        (false, None) => Err(Error::NotCompared { name: name.to_owned() }),
    }
}

fn check_unit(
    table: &ForeignTable,
    theirs: usize,
    unit: Option<Unit>,
    si: &'static str,
    ours: &str,
) -> Result<(), Error> {
    let column = &table.columns[theirs];
    match (unit, column.named().unknown) {
        (Some(unit), _) if unit.si != si => Err(Error::WrongUnit {
            column: column.name.clone(),
            unit: unit.text,
            ours: ours.to_owned(),
            si,
        }),
        (None, Some(unknown)) => {
            Err(Error::UnknownUnit { column: column.name.clone(), unit: unknown.to_owned() })
        }
        _ => Ok(()),
    }
}

/// What their names may mean.
struct Guesses {
    /// Their column, ours, how, unit.
    all: Vec<Mapped>,
}

impl Guesses {
    fn new(table: &ForeignTable, parts: &Parts, compared: &[Column]) -> Guesses {
        let meanings = meanings(parts);
        let guess = |(theirs, column): (usize, &ForeignColumn)| {
            let named = column.named();
            let [ours] = meanings.get(&plain(named.name))?.as_slice() else { return None };
            let fits = named.unit.is_none_or(|unit| unit.si == ours.dataset.unit);
            let certain = fits && named.unknown.is_none() && compared.contains(ours);
            let same = named.name.eq_ignore_ascii_case(&parts.name(ours));
            let how = if same { How::SameName } else { How::Guessed };
            certain.then_some(Mapped { theirs, ours: *ours, how, unit: named.unit })
        };
        Guesses { all: table.columns.iter().enumerate().filter_map(guess).collect() }
    }

    /// Leaves out what the command line has settled.
    fn drop_settled(&mut self, given: &Given, time: usize) {
        self.all.retain(|guess| {
            let settled = |given: &Mapped| given.theirs == guess.theirs || given.ours == guess.ours;
            guess.theirs != time && !given.columns.iter().any(settled)
        });
    }

    /// Whether a guess stands alone, or is the one with the very name.
    fn is_certain(&self, guess: &Mapped) -> bool {
        let rivals = |how: Option<How>| {
            let rival = |other: &&Mapped| {
                other.ours == guess.ours && how.is_none_or(|how| other.how == how)
            };
            self.all.iter().filter(rival).count()
        };
        match guess.how {
            How::SameName => rivals(Some(How::SameName)) == 1,
            How::Guessed | How::Given => rivals(None) == 1,
        }
    }

    fn certain(&self) -> impl Iterator<Item = Mapped> {
        self.all.iter().filter(|guess| self.is_certain(guess)).copied()
    }

    /// Says which of ours several of theirs may be, where none is taken.
    fn doubts(&self, table: &ForeignTable, parts: &Parts) -> Vec<String> {
        let mut rivals: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for guess in &self.all {
            let taken = self.certain().any(|certain| certain.ours == guess.ours);
            if !taken {
                let theirs = format!("\"{}\"", table.columns[guess.theirs].name);
                rivals.entry(parts.name(&guess.ours)).or_default().push(theirs);
            }
        }
        let doubt = |(ours, theirs): (String, Vec<String>)| {
            format!("{} may each be {ours}; --map says which, none is taken", theirs.join(" and "))
        };
        rivals.into_iter().map(doubt).collect()
    }
}

impl Guesses {
    /// What their names are near to, a line each.
    fn hints(&self, table: &ForeignTable, parts: &Parts, compared: &[Column]) -> String {
        let ours: Vec<String> = compared.iter().map(|column| parts.name(column)).collect();
        let near = |column: &ForeignColumn| {
            let hint = did_you_mean(&column.name, ours.iter().map(String::as_str));
            (!hint.is_empty()).then(|| format!("\"{}\"{hint}", column.name))
        };
        let doubts = self.doubts(table, parts);
        let known = if doubts.is_empty() {
            table.columns.iter().filter_map(near).collect()
        } else {
            doubts
        };
        known.iter().map(|hint| format!("\n  {hint}")).collect()
    }
}

/// A name as it is compared: letters and digits only, in lower case.
fn plain(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

/// Other names that a dataset goes by.
fn aliases(dataset: &str) -> &'static [&'static str] {
    match dataset {
        "position_x" => &["x", "pos_x", "x_pos"],
        "position_y" => &["y", "pos_y", "y_pos"],
        "angle" => &["theta", "phi", "θ", "φ"],
        "velocity_x" => &["vx", "v_x", "xdot", "vel_x"],
        "velocity_y" => &["vy", "v_y", "ydot", "vel_y"],
        "angular_velocity" => &["omega", "ω", "thetadot", "phidot", "angular_rate"],
        "acceleration_x" => &["ax", "a_x", "acc_x"],
        "acceleration_y" => &["ay", "a_y", "acc_y"],
        "angular_acceleration" => &["alpha", "α"],
        "normal_force" => &["fn", "f_n"],
        "tangential_force" => &["ft", "f_t", "friction_force"],
        "drive_torque" => &["torque"],
        _ => &[],
    }
}

/// Everything a plain name may mean.
fn meanings(parts: &Parts) -> BTreeMap<String, Vec<Column>> {
    let mut meanings: BTreeMap<String, Vec<Column>> = BTreeMap::new();
    for column in parts.columns() {
        let names = std::iter::once(column.dataset.name)
            .chain(aliases(column.dataset.name).iter().copied());
        for name in names {
            let mut forms = Vec::new();
            match parts.items(column.dataset) {
                Some(items) => {
                    let item = &items[column.item];
                    forms.extend([format!("{name}{item}"), format!("{item}{name}")]);
                    if items.len() == 1 {
                        forms.push(name.to_owned());
                    }
                }
                None => forms.push(name.to_owned()),
            }
            for form in forms {
                let known = meanings.entry(plain(&form)).or_default();
                if !known.contains(&column) {
                    known.push(column);
                }
            }
        }
    }
    meanings
}

#[cfg(test)]
mod tests {
    use super::super::foreign::Format;
    use super::super::quantity::tests::four_bar;
    use super::*;

    fn table(names: &[&str]) -> ForeignTable {
        let columns = names.iter().map(|name| ForeignColumn {
            name: (*name).to_owned(),
            values: vec![0.0],
            text: None,
            written_digits: None,
        });
        ForeignTable {
            path: "theirs.csv".into(),
            format: Format::Text,
            columns: columns.collect(),
            misfits: Vec::new(),
            ends_within_a_line: false,
        }
    }

    fn mapping(names: &[&str], maps: &[&str]) -> Result<Mapping, Error> {
        let parts = four_bar();
        let maps: Vec<Map> = maps.iter().map(|map| map.parse().unwrap()).collect();
        Mapping::new(&table(names), &parts, &parts.compared(false), &maps)
    }

    /// Pairs of their names and ours.
    fn pairs(names: &[&str], maps: &[&str]) -> Vec<(String, String)> {
        let mapping = mapping(names, maps).unwrap();
        let pair = |m: &Mapped| (names[m.theirs].to_owned(), four_bar().name(&m.ours));
        mapping.columns.iter().map(pair).collect()
    }

    #[test]
    fn names_that_say_what_and_of_which_body_are_guessed() {
        for (theirs, ours) in [
            ("angle.coupler", "angle.coupler"),
            ("Angle.Coupler", "angle.coupler"),
            ("angle_coupler", "angle.coupler"),
            ("coupler angle", "angle.coupler"),
            ("theta_coupler [deg]", "angle.coupler"),
            ("coupler_omega", "angular_velocity.coupler"),
            ("coupler_vx", "velocity_x.coupler"),
            ("follower_x", "position_x.follower"),
            ("A_clearance_x", "clearance_x.A"),
            ("clearance_y", "clearance_y.A"),
        ] {
            let found = pairs(&["t", theirs], &[]);
            assert_eq!(found, [(theirs.to_owned(), ours.to_owned())]);
        }
    }

    #[test]
    fn names_that_leave_a_doubt_are_not() {
        for theirs in ["angle", "theta3", "x", "A_force_x", "coupler", "theta_coupler [mm]"] {
            let found = mapping(&["t", theirs], &[]);
            assert!(matches!(found, Err(Error::NothingInCommon { .. })), "{theirs}: {found:?}");
        }
    }

    #[test]
    fn two_columns_that_mean_the_same_are_both_left_out() {
        let names = ["t", "theta_coupler", "phi_coupler", "coupler_omega"];
        assert_eq!(pairs(&names, &[]).len(), 1);
        let notes = mapping(&names, &[]).unwrap().notes;
        assert!(notes[0].contains("\"theta_coupler\" and \"phi_coupler\""), "{notes:?}");
        let settled = pairs(&names, &["phi_coupler=angle.coupler"]);
        assert_eq!(settled[0].0, "phi_coupler");
        let own_name = pairs(&["t", "theta_coupler", "angle.coupler"], &[]);
        assert_eq!(own_name, [("angle.coupler".to_owned(), "angle.coupler".to_owned())]);
    }

    #[test]
    fn a_table_with_nothing_of_ours_is_told_what_its_names_are_near_to() {
        let told = |names: &[&str]| mapping(names, &[]).unwrap_err().to_string();
        let near = told(&["t", "angel.coupler"]);
        assert!(near.contains("\"angel.coupler\" (did you mean \"angle.coupler\"?)"), "{near}");
        let twice = told(&["t", "angle.coupler", "angle.coupler"]);
        assert!(twice.contains("may each be angle.coupler"), "{twice}");
        assert!(!told(&["t", "qux"]).contains("did you mean"));
    }

    #[test]
    fn the_command_line_names_columns_and_units() {
        let names = ["T", "y(:,3)", "w3 [deg/s]"];
        let maps = ["T[ms]=time", "y(:,3)[deg]=angle.coupler", "w3=angular_velocity.coupler"];
        let mapping = mapping(&names, &maps).unwrap();
        let unit = |unit: Option<Unit>| unit.unwrap().text;
        assert_eq!(unit(mapping.time_unit), "ms");
        let units: Vec<&str> = mapping.columns.iter().map(|mapped| unit(mapped.unit)).collect();
        assert_eq!(units, ["deg", "deg/s"]);
    }

    #[test]
    fn a_map_that_does_not_fit_is_told() {
        for (maps, word) in [
            (vec!["phi=angle.coupler"], "phi"),
            (vec!["x=angle.cuopler"], "did you mean"),
            (vec!["x=normal_force.A"], "--forces"),
            (vec!["x=energy_kinetic"], "not compared"),
            (vec!["x[mm]=angle.coupler"], "mm"),
            (vec!["x[furlong]=angle.coupler"], "furlong"),
            (vec!["x=angle.coupler", "z=angle.coupler"], "twice"),
        ] {
            let complaint = mapping(&["t", "x", "z"], &maps).unwrap_err().to_string();
            assert!(complaint.contains(word), "{maps:?}: {complaint}");
        }
        assert!("angle.coupler".parse::<Map>().is_err());
    }

    #[test]
    fn a_table_without_times_is_refused() {
        let complaint = mapping(&["x", "angle.coupler"], &[]).unwrap_err().to_string();
        assert!(complaint.contains("--map"), "{complaint}");
    }
}
