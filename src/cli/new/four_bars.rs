//! N four-bar linkages side by side: benchmark A02 of the library of computational benchmark
//! problems of the IFToMM committee for multibody dynamics (González, Dopico, Lugrís, Cuadrado 2006,
//! *Multibody System Dynamics* 16, 179–190).

use std::fmt::{self, Write};

/// The text of a case of so many four-bars.
pub(super) fn four_bars(count: u16) -> String {
    let mut text = String::new();
    // writing to a string cannot fail
    let _ = write(&mut text, count);
    text
}

fn write(out: &mut impl Write, count: u16) -> fmt::Result {
    let (links, cranks) = (2 * u32::from(count) + 1, u32::from(count) + 1);
    write!(
        out,
        "\
# {count} four-bar linkages in a row: {cranks} cranks on the ground, all alike, and couplers from the end
# of each to the end of the next. {links} links with one freedom.
#
# Lengths in m, masses in kg, angles in rad, forces in N: SI throughout. Numbers are read as decimals,
# exactly as written. docs/format.md explains every key.
#
#   freeplay check FILE      what this describes, before anything is run
#   freeplay run FILE        simulates it into a result file

title = \"Four-bars in a row, {count} of them\"

[ground]                                # points that stay where they are, in the fixed frame
"
    )?;
    for i in 0..cranks {
        writeln!(out, "points.O{i} = [{i}.0, 0.0]")?;
    }
    let rod = |out: &mut dyn Write, name: &str, number: u32, [from, to]: [&str; 2]| {
        writeln!(
            out,
            "\n[bodies.{name}{number}]\nmass    = 1.0\ninertia = 0.083333333333333333\n\
             points  = {{ {from} = [-0.5, 0.0], {to} = [0.5, 0.0] }}"
        )
    };
    writeln!(out, "\n# Rods of 1 m and 1 kg; inertia = mass · length² / 12.")?;
    for i in 0..cranks {
        rod(out, "crank", i, ["O", "E"])?;
    }
    for i in 1..cranks {
        rod(out, "coupler", i, ["L", "R"])?;
    }
    let joint = |out: &mut dyn Write, name: &str, number: u32, [first, second]: [String; 2]| {
        writeln!(
            out,
            "\n[joints.{name}{number}]\nkind    = \"revolute\"\nbetween = [\"{first}\", \"{second}\"]"
        )
    };
    for i in 0..cranks {
        joint(out, "O", i, [format!("ground.O{i}"), format!("crank{i}.O")])?;
    }
    for i in 1..cranks {
        joint(out, "L", i, [format!("crank{}.E", i - 1), format!("coupler{i}.L")])?;
        joint(out, "R", i, [format!("coupler{i}.R"), format!("crank{i}.E")])?;
    }
    write!(
        out,
        "
[loads.gravity]
kind         = \"gravity\"
acceleration = [0.0, -9.81]             # m/s²; [0.0, 9.81] lets the cranks hang

[start]                                 # upright, the ends of the cranks move at 1 m/s
crank0 = {{ angle = 1.5707963267948966, angular_velocity = -1.0, fixed = true }}
"
    )?;
    for i in 1..cranks {
        writeln!(out, "crank{i} = {{ x = {i}.0, y = 0.5, angle = 1.5707963267948966 }}")?;
    }
    for i in 1..cranks {
        writeln!(out, "coupler{i} = {{ x = {}.5, y = 1.0, angle = 0.0 }}", i - 1)?;
    }
    write!(
        out,
        "
[run]
duration        = 10.0                  # s; the links come to lie flat ten times, from 0.7 s on
sample_interval = 1e-2                  # s

[solver]
engine             = \"explicit\"       # large steps where nothing strikes
absolute_tolerance = \"scaled\"         # the couplers' angles stay zero
"
    )
}
