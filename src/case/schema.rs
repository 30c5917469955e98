//! The JSON Schema of case files, and the same in tables. Joints, drives, loads and courses come from
//! what their kinds say of themselves; the other keys stand in `schema.json`.

use crate::contact::{Damping, elastic, viscous};
use crate::parameter::{Key, Kind, Otherwise, Range, Takes};
use crate::{course, friction, joint, load};
use serde_json::{Map, Value, json};

/// The schema of what does not come in kinds.
const REST: &str = include_str!("schema.json");

const NORMAL: &str =
    "Law of the normal force: of its damping and, by `elastic`, of its elastic part";
const FRICTION: &str = "Law of the tangential force; left out: none";

/// The JSON Schema (draft 07) of case files.
pub fn schema() -> Value {
    let mut schema: Value = serde_json::from_str(REST).unwrap_or_default();
    let kinds = [
        ("joint", "A joint", one_of("kind", joint::KINDS, joint_keys)),
        ("drive", "A drive", one_of("kind", course::KINDS, |_| drive_keys())),
        ("load", "A load", one_of("kind", load::KINDS, |_| Map::new())),
        ("course", "A course of time", one_of("kind", course::KINDS, |_| Map::new())),
        ("normal", NORMAL, one_of("elastic", elastic::KINDS, |_| normal_keys())),
        ("friction", FRICTION, one_of("law", friction::KINDS, |_| Map::new())),
    ];
    for (name, about, alternatives) in kinds {
        schema["$defs"][name] = json!({ "description": about, "oneOf": alternatives });
    }
    let viscous = one_of("law", viscous::KINDS, |_| Map::new());
    if let Some(alternatives) = schema["$defs"]["normal"]["oneOf"].as_array_mut() {
        // they go with the power law alone
        let power = alternatives[0]["properties"].clone();
        alternatives.extend(viscous.into_iter().map(|mut law| {
            for (key, value) in power.as_object().into_iter().flatten() {
                let other = ["law", "restitution", "achieved_restitution"].contains(&key.as_str());
                if !other {
                    law["properties"][key] = value.clone();
                }
            }
            if let Some(required) = law["required"].as_array_mut() {
                required.push(json!("stiffness"));
            }
            law
        }));
    }
    share_contact_keys(&mut schema["$defs"]);
    default_kind(&mut schema["$defs"]["drive"], "kind", "speed");
    default_kind(&mut schema["$defs"]["normal"], "elastic", elastic::POWER.word);
    schema
}

/// Gives guides and slots the keys of what happens in a contact, which stand with the bearing's.
fn share_contact_keys(defs: &mut Value) {
    let bearing = defs["clearance"]["properties"].clone();
    for (key, value) in bearing.as_object().into_iter().flatten() {
        if !["bearing_radius", "radial"].contains(&key.as_str()) {
            for play in ["guide", "slot"] {
                defs[play]["properties"][key] = value.clone();
            }
        }
    }
}

/// Lets the key that chooses a kind be left out, where one kind is the default.
fn default_kind(family: &mut Value, chooses: &str, word: &str) {
    for kind in family["oneOf"].as_array_mut().into_iter().flatten() {
        if kind["properties"][chooses]["const"] == word {
            kind["properties"][chooses]["default"] = json!(word);
            if let Some(required) = kind["required"].as_array_mut() {
                required.retain(|key| key != chooses);
            }
        }
    }
}

/// Keys of a normal force that are those of no elastic law.
fn normal_keys() -> Map<String, Value> {
    let laws: Vec<&str> = Damping::ALL.iter().map(|(word, _)| *word).collect();
    let restitution = |about: &str| json!({ "type": "number", "description": about, "exclusiveMinimum": 0, "maximum": 1 });
    let nominal = "Restitution c_e, as the law has it (`freeplay laws` tells what an impact then \
                   rebounds at); none for hertz";
    let achieved = "In place of restitution: what one impact by itself is to rebound at, over its \
                    speed";
    Map::from_iter([
        (
            "law".to_owned(),
            json!({ "type": "string", "description": "The law of the damping", "enum": laws }),
        ),
        ("restitution".to_owned(), restitution(nominal)),
        ("achieved_restitution".to_owned(), restitution(achieved)),
    ])
}

/// Keys of a joint that are those of no kind.
fn joint_keys(kind: &Kind) -> Map<String, Value> {
    let mut keys = Map::new();
    let play = match kind.word {
        joint::REVOLUTE => "clearance",
        joint::PRISMATIC => "guide",
        joint::PIN_SLOT => "slot",
        _ => return keys,
    };
    keys.insert("clearance".into(), json!({ "$ref": format!("#/$defs/{play}") }));
    keys
}

fn drive_keys() -> Map<String, Value> {
    let about = "name of its joint: the angle of a revolute joint is driven, the travel of a \
                 prismatic one";
    let joint = json!({ "type": "string", "description": about });
    Map::from_iter([("joint".to_owned(), joint)])
}

/// One schema for each kind, which a key chooses, with keys before its own.
fn one_of(
    chooses: &str,
    kinds: &[&Kind],
    before: impl Fn(&Kind) -> Map<String, Value>,
) -> Vec<Value> {
    let schema_of = |kind: &&Kind| {
        let mut keys = Map::new();
        keys.insert(chooses.into(), json!({ "const": kind.word, "description": kind.title }));
        let others = before(kind);
        let mut required = vec![chooses];
        let needed = ["joint", "law"].into_iter().filter(|key| others.contains_key(*key));
        required.extend(needed);
        keys.extend(others.clone());
        for key in kind.keys {
            keys.insert(key.name.into(), value(key));
            if key.otherwise == Otherwise::Required {
                required.push(key.name);
            }
        }
        json!({
            "type": "object",
            "title": kind.word,
            "description": kind.title,
            "properties": keys,
            "required": required,
            "additionalProperties": false,
        })
    };
    kinds.iter().map(schema_of).collect()
}

/// The schema of the value of a key.
fn value(key: &Key) -> Value {
    let pair = |items: &str| json!({ "type": "array", "items": { "type": items }, "minItems": 2, "maxItems": 2 });
    let mut schema = match key.takes {
        Takes::Number(range) => number(range),
        Takes::Vector(_) => pair("number"),
        Takes::Points | Takes::Bodies => pair("string"),
        Takes::Point | Takes::Body | Takes::Joint(_) => json!({ "type": "string" }),
        Takes::Word(words) => json!({ "type": "string", "enum": words }),
        Takes::Course => json!({ "oneOf": [{ "type": "number" }, { "$ref": "#/$defs/course" }] }),
        Takes::NumberOr(range, words) => {
            json!({ "oneOf": [number(range), { "type": "string", "enum": words }] })
        }
        Takes::Friction => json!({ "$ref": "#/$defs/friction" }),
        Takes::Numbers => json!({ "type": "array", "items": { "type": "number" }, "minItems": 2 }),
        Takes::File => json!({ "type": "string" }),
        Takes::OfMaterials(range) => json!({ "oneOf": [number(range), pair("number")] }),
    };
    let unit = if key.unit.is_empty() { String::new() } else { format!(" ({})", key.unit) };
    schema["description"] = json!(format!("{}{unit}", key.about));
    if let Otherwise::Default(default) = key.otherwise {
        schema["default"] = serde_json::from_str(default).unwrap_or_default();
    }
    schema
}

fn number(range: Range) -> Value {
    match range {
        Range::Any => json!({ "type": "number" }),
        Range::Positive => json!({ "type": "number", "exclusiveMinimum": 0 }),
        Range::NotNegative => json!({ "type": "number", "minimum": 0 }),
        Range::NotZero => json!({ "type": "number", "not": { "const": 0 } }),
        Range::AtLeastOne => json!({ "type": "number", "minimum": 1 }),
        Range::Restitution => {
            json!({ "type": "number", "exclusiveMinimum": 0, "maximum": 1 })
        }
        Range::PoissonRatio => {
            json!({ "type": "number", "exclusiveMinimum": -1, "maximum": 0.5 })
        }
    }
}

/// Every key of a case file in tables, in Markdown.
pub fn tables() -> String {
    let schema = schema();
    let mut text = String::from(
        "# Keys of case files\n\nMade by `freeplay schema --markdown` from what the program reads. SI \
         throughout: m, kg, s, rad, N.\n\n`freeplay schema > case.schema.json` writes the same for \
         editors: with a TOML language server (taplo, Even Better TOML), `#:schema case.schema.json` \
         in the first line of a case has its keys completed, explained and checked as you type.\n",
    );
    let defs = &schema["$defs"];
    table(&mut text, "The case", "", &schema);
    table(&mut text, "Ground: `[ground]`", "", &schema["properties"]["ground"]);
    table(&mut text, "Bodies: `[bodies.NAME]`", "", &defs["body"]);
    kinds(&mut text, "Joints: `[joints.NAME]`", &defs["joint"], joint::KINDS);
    let clearance = |of: &str| format!("Clearance of a {of}: `[joints.NAME.clearance]`");
    table(&mut text, &clearance("revolute joint"), "", &defs["clearance"]);
    table(&mut text, &clearance("prismatic joint"), "", &defs["guide"]);
    table(&mut text, &clearance("pin in a slot"), "", &defs["slot"]);
    let normal =
        "Normal force: `normal` of a clearance, by its elastic law, or by a law of its own";
    kinds(&mut text, normal, &defs["normal"], &[elastic::KINDS, viscous::KINDS].concat());
    kinds(&mut text, "Friction: `friction` of a clearance", &defs["friction"], friction::KINDS);
    kinds(&mut text, "Drives: `[drives.NAME]`", &defs["drive"], course::KINDS);
    kinds(&mut text, "Loads: `[loads.NAME]`", &defs["load"], load::KINDS);
    kinds(&mut text, "Courses: values that change with time", &defs["course"], course::KINDS);
    table(&mut text, "Start: `[start]`", "", &schema["properties"]["start"]);
    table(&mut text, "Start of a body: `NAME = { … }` in `[start]`", "", &defs["start"]);
    let contact = "Open contacts: `[[start.contact]]`";
    table(&mut text, contact, "", &defs["contact"]);
    table(&mut text, "What is remembered: `[[start.memory]]`", "", &defs["memory"]);
    table(&mut text, "Observers: `[observe]`", "", &schema["properties"]["observe"]);
    table(&mut text, "Run: `[run]`", "", &schema["properties"]["run"]);
    table(&mut text, "Windows of samples: `[[run.window]]`", "", &defs["window"]);
    table(&mut text, "Solver: `[solver]`", "", &schema["properties"]["solver"]);
    text
}

/// The tables of every kind of a family.
fn kinds(text: &mut String, title: &str, family: &Value, kinds: &[&Kind]) {
    text.push_str(&format!("\n## {title}\n"));
    let alternatives = family["oneOf"].as_array().map_or(&[][..], Vec::as_slice);
    for (kind, schema) in kinds.iter().zip(alternatives) {
        let example = match family["description"] == "A drive" && !kind.example.contains("drives") {
            true => String::new(),
            false => format!("\n```toml\n{}\n```\n", kind.example),
        };
        let about = format!("{}.\n{example}", capital(kind.title));
        table(text, &format!("# `{}`", kind.word), &about, schema);
    }
}

/// The keys of one table.
fn table(text: &mut String, title: &str, about: &str, schema: &Value) {
    text.push_str(&format!("\n##{}{title}\n", if title.starts_with('#') { "" } else { " " }));
    if !about.is_empty() {
        text.push_str(&format!("\n{about}"));
    }
    let keys = schema["properties"].as_object();
    let required = schema["required"].as_array().map_or(&[][..], Vec::as_slice);
    text.push_str("\n| key | meaning | takes | if left out |\n|---|---|---|---|\n");
    for (key, value) in keys.into_iter().flatten() {
        let otherwise = match (&value["default"], required.iter().any(|name| name == key)) {
            (Value::Null, true) => "an error".to_owned(),
            (Value::Null, false) => String::new(),
            (default, _) => format!("`{default}`"),
        };
        let about = value["description"].as_str().unwrap_or_default().replace('|', "\\|");
        text.push_str(&format!("| `{key}` | {about} | {} | {otherwise} |\n", takes(value)));
    }
}

/// The unit of a dotted key, `joints.A.clearance.radial`: m; `None` where it has none.
pub fn unit_of(key: &str) -> Option<String> {
    let schema = schema();
    let keys = toml_edit::Key::parse(key).ok()?;
    let mut here = vec![&schema];
    for key in &keys {
        let below = here.into_iter().flat_map(|at| alternatives(&schema, at));
        here = below.filter_map(|at| below_of(at, key.get())).collect();
    }
    here.into_iter().find_map(|at| {
        let (_, behind) = at["description"].as_str()?.split_once('(')?;
        let (unit, _) = behind.split_once(')')?;
        let about_numbers = takes(at).contains("number");
        about_numbers.then(|| unit.replace("revolutions a minute", "rpm"))
    })
}

/// A part of the schema, or those of which it is one.
fn alternatives<'s>(schema: &'s Value, at: &'s Value) -> Vec<&'s Value> {
    let at = match at["$ref"].as_str().and_then(|to| to.strip_prefix("#/$defs/")) {
        Some(name) => &schema["$defs"][name],
        None => at,
    };
    at["oneOf"].as_array().map_or(vec![at], |kinds| kinds.iter().collect())
}

/// What a key leads to.
fn below_of<'s>(at: &'s Value, key: &str) -> Option<&'s Value> {
    let named = at["properties"].get(key);
    let any = || at.get("additionalProperties").or(at.get("items")).filter(|any| any.is_object());
    named.or_else(any)
}

/// What a value is, in words.
fn takes(value: &Value) -> String {
    if let Some(word) = value["const"].as_str() {
        return format!("`\"{word}\"`");
    }
    if let Some(words) = value["enum"].as_array() {
        let words: Vec<String> = words.iter().map(|word| format!("`{word}`")).collect();
        return words.join(" or ");
    }
    if let Some(either) = value["oneOf"].as_array() {
        return either.iter().map(takes).collect::<Vec<_>>().join(" or ");
    }
    if let Some(reference) = value["$ref"].as_str() {
        return format!("a {}", reference.trim_start_matches("#/$defs/"));
    }
    match value["type"].as_str() {
        Some("number") => format!("number{}", limits(value)),
        Some("boolean") => "`true` or `false`".into(),
        Some("array") if value["items"]["$ref"].is_string() => "tables".into(),
        Some("array") if value["maxItems"].is_null() => {
            format!("{}s", value["items"]["type"].as_str().unwrap_or("value"))
        }
        Some("array") => format!("two {}s", value["items"]["type"].as_str().unwrap_or("value")),
        Some("object") => "table".into(),
        other => other.unwrap_or_default().to_owned(),
    }
}

fn limits(value: &Value) -> String {
    let limit = |key: &str, sign: &str| {
        let bound = &value[key];
        (!bound.is_null()).then(|| format!("{sign} {bound}"))
    };
    let not = value["not"]["const"].as_i64().map(|not| format!("≠ {not}"));
    let all = [
        limit("exclusiveMinimum", ">"),
        limit("minimum", "≥"),
        limit("exclusiveMaximum", "<"),
        limit("maximum", "≤"),
        not,
    ];
    let all: Vec<String> = all.into_iter().flatten().collect();
    if all.is_empty() { String::new() } else { format!(" {}", all.join(", ")) }
}

fn capital(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}
