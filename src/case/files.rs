//! Files that belong to a case (`file = "motion.csv"`): the numbers that they hold take the place of
//! their names, so that the text of a case as run needs no file beside it.

use super::source;
use crate::model::{Complaint, KeyPath};
use crate::parameter::{Kind, Takes};
use crate::scalar::Decimal;
use crate::{course, load};
use std::error::Error;
use std::path::Path;
use toml_edit::{Array, DocumentMut, Item, TableLike, Value};

/// Puts what the files of a case hold into its document; `path` is that of the case. Gives whether
/// there was any, or what is wrong with them.
pub(super) fn take_in(path: &Path, document: &mut DocumentMut) -> Result<bool, Vec<Complaint>> {
    let beside = path.parent().unwrap_or(Path::new(""));
    let (mut any, mut complaints) = (false, Vec::new());
    for list in ["drives", "loads"] {
        let Some(parts) = document.get_mut(list).and_then(Item::as_table_like_mut) else {
            continue;
        };
        for (name, part) in parts.iter_mut() {
            let key = KeyPath::new([list, name.get()]);
            if let Some(part) = part.as_table_like_mut() {
                any |= take_in_part(beside, &key, part, &mut complaints);
            }
        }
    }
    if complaints.is_empty() { Ok(any) } else { Err(complaints) }
}

/// The same of one part and the courses in it.
fn take_in_part(
    beside: &Path,
    key: &KeyPath,
    part: &mut dyn TableLike,
    complaints: &mut Vec<Complaint>,
) -> bool {
    let mut any = false;
    for (name, below) in part.iter_mut() {
        let key = key.key(name.get());
        if let Some(below) = below.as_table_like_mut() {
            any |= take_in_part(beside, &key, below, complaints);
        }
    }
    let mut kinds = course::KINDS.iter().chain(load::KINDS);
    let word = part.get("kind").and_then(Item::as_str);
    let kind = kinds.find(|kind| Some(kind.word) == word);
    let Some((file, columns)) = kind.and_then(|kind| file_and_columns(kind)) else { return any };
    let Some(name) = part.get(file).and_then(Item::as_str).map(str::to_owned) else { return any };
    let wrong = |message| Complaint { key: key.key(file), message };
    if let Some(other) = columns.iter().find(|column| part.contains_key(column)) {
        complaints.push(wrong(format!("{other} are given too: one of the two says what they are")));
        return any;
    }
    match read(&beside.join(&name), &name, &columns) {
        Ok(numbers) => {
            part.remove(file);
            for (column, numbers) in columns.into_iter().zip(numbers) {
                part.insert(column, Item::Value(Value::Array(numbers)));
            }
            true
        }
        Err(message) => {
            complaints.push(wrong(message));
            any
        }
    }
}

/// The key of a kind that names a file, and the keys that its columns are.
fn file_and_columns(kind: &Kind) -> Option<(&'static str, Vec<&'static str>)> {
    let file = kind.keys.iter().find(|key| key.takes == Takes::File)?.name;
    let columns = kind.keys.iter().filter(|key| key.takes == Takes::Numbers);
    Some((file, columns.map(|key| key.name).collect()))
}

/// The columns of a file: numbers between commas, semicolons, tabs or spaces. Lines that are empty or
/// begin with `#` say nothing; nor does the first of the others, if it begins with no number.
fn read(path: &Path, name: &str, columns: &[&str]) -> Result<Vec<Array>, String> {
    let text = source::read_text(path).map_err(|error| {
        let cause = error.source().map_or(String::new(), |cause| format!(": {cause}"));
        let error = error.to_string().replace("case file ", "");
        format!("{error}{cause}; it is looked for beside the case")
    })?;
    let mut lists = vec![Array::new(); columns.len()];
    let lines = text.lines().enumerate().map(|(k, line)| (k + 1, line.trim()));
    let lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    for (place, (number, line)) in lines.enumerate() {
        let separators = |c: char| c.is_whitespace() || c == ',' || c == ';';
        let fields: Vec<&str> = line.split(separators).filter(|f| !f.is_empty()).collect();
        let numbers: Option<Vec<Value>> = fields.iter().map(|field| as_number(field)).collect();
        match numbers.filter(|numbers| numbers.len() == columns.len()) {
            Some(numbers) => {
                lists.iter_mut().zip(numbers).for_each(|(list, number)| list.push(number));
            }
            None if place == 0 && fields.first().is_none_or(|f| as_number(f).is_none()) => {}
            None => {
                let wanted = columns.join(" and ");
                let found = crate::model::shortened(line);
                let many = columns.len();
                return Err(format!(
                    "line {number} of {name} must be {many} numbers, {wanted}, is {found:?}"
                ));
            }
        }
    }
    Ok(lists)
}

/// A number as TOML writes it.
pub(super) fn as_number(field: &str) -> Option<Value> {
    let begins =
        field.trim_start_matches(['+', '-']).starts_with(|c: char| c.is_ascii_digit() || c == '.');
    let number = Decimal::new(field).ok().filter(|_| begins)?.to_string();
    let (sign, number) = match number.strip_prefix('-') {
        Some(number) => ("-", number),
        None => ("", number.as_str()),
    };
    let (mantissa, exponent) = match number.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, format!("e{exponent}")),
        None => (number, String::new()),
    };
    let (whole, part) = mantissa.split_once('.').unwrap_or((mantissa, "0"));
    let whole = whole.trim_start_matches('0');
    let whole = if whole.is_empty() { "0" } else { whole };
    let part = if part.is_empty() { "0" } else { part };
    format!("{sign}{whole}.{part}{exponent}").parse().ok()
}
