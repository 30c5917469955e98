//! What the runs of several result files are called beside each other.

use super::{Error, ResultFile};
use std::path::Path;

/// Names of the runs of some files, no two the same: the labels, if there are any; else the names
/// of their cases, or of their files with as many folders before them as it takes to tell them
/// apart.
///
/// # Errors
/// There are not as many labels as files, or two labels are the same.
pub fn names_of_runs(files: &[ResultFile], labels: &[String]) -> Result<Vec<String>, Error> {
    if !labels.is_empty() {
        return checked(labels, files.len());
    }
    let paths: Vec<&Path> = files.iter().map(ResultFile::path).collect();
    let case = |file: &ResultFile| match file.text("case_name") {
        Some(name) if !name.is_empty() => name.to_owned(),
        _ => tail(file.path(), 1),
    };
    let cases: Vec<String> = files.iter().map(case).collect();
    Ok(told_apart(&cases.iter().map(String::as_str).collect::<Vec<_>>(), &paths))
}

fn checked(labels: &[String], files: usize) -> Result<Vec<String>, Error> {
    if labels.len() != files {
        return Err(Error::Labels { labels: labels.len(), files });
    }
    if let Some(k) = (1..files).find(|k| labels[..*k].contains(&labels[*k])) {
        return Err(Error::SameLabel { label: labels[k].clone() });
    }
    Ok(labels.to_vec())
}

/// Names that tell runs apart: a run keeps a name that no other has; others are called by their
/// files, with as many folders before them as it takes, and by their number if that is not enough.
fn told_apart(names: &[&str], paths: &[&Path]) -> Vec<String> {
    let count = |name: &str| names.iter().filter(|other| **other == name).count();
    let most = paths.iter().map(|path| path.components().count()).max().unwrap_or(0);
    let name = |k: usize| {
        if count(names[k]) == 1 {
            return names[k].to_owned();
        }
        let by_path = (1..=most).find_map(|folders| {
            let tails: Vec<String> = paths.iter().map(|path| tail(path, folders)).collect();
            let alone = tails.iter().filter(|other| **other == tails[k]).count() == 1;
            (alone && count(&tails[k]) != 1).then(|| tails[k].clone())
        });
        by_path.unwrap_or_else(|| format!("{} ({})", tail(paths[k], 1), k + 1))
    };
    (0..names.len()).map(name).collect()
}

/// The last parts of a path, without the file's ending.
fn tail(path: &Path, parts: usize) -> String {
    let path = path.with_extension("");
    let parts_of = path.components().map(|part| part.as_os_str().to_string_lossy());
    let skipped = parts_of.clone().count().saturating_sub(parts);
    parts_of.skip(skipped).collect::<Vec<_>>().join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_one_name_are_told_apart_by_as_much_of_their_paths_as_it_takes() {
        for (names, paths, expected) in [
            (["a", "b", "c"], ["x/r.h5", "y/r.h5", "r.h5"], ["a", "b", "c"]),
            (["a", "a", "b"], ["x/one.h5", "x/two.h5", "r.h5"], ["one", "two", "b"]),
            (["a", "a", "a"], ["x/r.h5", "y/r.h5", "y/s.h5"], ["x/r", "y/r", "s"]),
            (["a", "a", "a"], ["/k/x/r.h5", "/l/x/r.h5", "r.h5"], ["k/x/r", "l/x/r", "r"]),
            (["a", "a", "b"], ["r.h5", "r.h5", "r.h5"], ["r (1)", "r (2)", "b"]),
            (["a", "a", "r"], ["x/r.h5", "x/s.h5", "t.h5"], ["x/r", "s", "r"]),
        ] {
            let paths = paths.map(Path::new);
            assert_eq!(told_apart(&names, &paths), expected, "{names:?} {paths:?}");
        }
    }

    #[test]
    fn each_file_needs_a_label_of_its_own() {
        let checked = |labels: [&str; 2], files| checked(&labels.map(str::to_owned), files);
        assert_eq!(checked(["soft", "stiff"], 2).unwrap(), ["soft", "stiff"]);
        assert!(matches!(checked(["a", "b"], 3), Err(Error::Labels { labels: 2, files: 3 })));
        let same = checked(["a", "a"], 2).unwrap_err();
        assert_eq!(same.to_string(), "two files have the label \"a\"; each needs its own");
    }
}
