//! Text with columns: CSV, semicolons, tabs, blanks; `#` or `%` begin a comment, behind which the
//! line of names may stand.

use super::{ForeignColumn, ForeignTable, Format, Misplaced};
use crate::compare::Error;
use std::path::Path;

/// Separators looked for in the line of names, in this order; blanks if it has none.
const SEPARATORS: [char; 3] = [',', ';', '\t'];

/// Reads a text.
///
/// # Errors
/// There is no line of names, or a line has another number of fields.
pub(super) fn read(path: &Path, text: &str) -> Result<ForeignTable, Error> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let Some(head) = head(path, text)? else {
        return Err(Error::Empty { path: path.to_owned() });
    };
    let columns = head.names.iter().map(|name| ForeignColumn {
        name: name.clone(),
        values: Vec::new(),
        text: None,
        written_digits: Some(0),
    });
    let mut rows = Rows { path, columns: columns.collect() };
    match head.separator {
        ' ' => rows.read_blank(text, head.body)?,
        separator => rows.read_separated(text, head.body, separator)?,
    }
    let columns = rows.columns;
    if columns.iter().all(|column| column.values.is_empty()) {
        return Err(Error::Empty { path: path.to_owned() });
    }
    let ends_within_a_line = !text.ends_with(['\n', '\r']);
    Ok(ForeignTable {
        path: path.to_owned(),
        format: Format::Text,
        columns,
        misfits: Vec::new(),
        ends_within_a_line,
    })
}

/// The rows read so far.
struct Rows<'a> {
    path: &'a Path,
    columns: Vec<ForeignColumn>,
}

impl Rows<'_> {
    /// Reads rows whose fields stand apart by blanks, from line `body` on, counted from 0.
    fn read_blank(&mut self, text: &str, body: usize) -> Result<(), Error> {
        for (line, row) in text.lines().enumerate().skip(body) {
            if !row.trim().is_empty() && !is_comment(row) {
                self.add(line as u64 + 1, row.split_whitespace())?;
            }
        }
        Ok(())
    }

    /// Reads rows whose fields stand apart by a separator, from line `body` on, counted from 0.
    fn read_separated(&mut self, text: &str, body: usize, separator: char) -> Result<(), Error> {
        let before: usize = text.split_inclusive('\n').take(body).map(str::len).sum();
        let mut reader = reader(&text[before..], separator);
        let mut record = csv::StringRecord::new();
        loop {
            let line = body as u64 + reader.position().line();
            match reader.read_record(&mut record) {
                Ok(true) => {}
                Ok(false) => return Ok(()),
                Err(error) => return Err(unparsable(self.path, line, &error)),
            }
            let line = record.position().map_or(line, |at| body as u64 + at.line());
            let first = record.get(0).unwrap_or_default();
            let blank = record.len() == 1 && first.is_empty();
            if !blank && !is_comment(first) {
                self.add(line, record.iter())?;
            }
        }
    }

    fn add<'a>(&mut self, line: u64, cells: impl Iterator<Item = &'a str>) -> Result<(), Error> {
        let mut fields = 0;
        for cell in cells {
            if let Some(column) = self.columns.get_mut(fields) {
                column.add(line, cell.trim_matches('"'));
            }
            fields += 1;
        }
        let names = self.columns.len();
        if fields == names {
            return Ok(());
        }
        Err(Error::Ragged { path: self.path.to_owned(), line, fields, names })
    }
}

fn reader(text: &str, separator: char) -> csv::Reader<&[u8]> {
    csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(separator as u8)
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes())
}

fn unparsable(path: &Path, line: u64, error: &csv::Error) -> Error {
    Error::Unparsable { path: path.to_owned(), line, message: error.to_string() }
}

/// The line of names, and what follows from it.
struct Head {
    names: Vec<String>,
    separator: char,
    /// Index of the first line behind it.
    body: usize,
}

/// Finds the line of names: the first line, or the comment right above the numbers. `None` if
/// there is nothing but comments.
fn head(path: &Path, text: &str) -> Result<Option<Head>, Error> {
    let mut comment = None;
    for (number, line) in text.lines().enumerate() {
        if line.trim().is_empty() {
            continue;
        }
        if is_comment(line) {
            comment = Some((number, line.trim_start().trim_start_matches(['#', '%'])));
            continue;
        }
        let separator = separator(line);
        let cells = fields(path, number as u64 + 1, line, separator)?;
        if !cells.iter().all(|cell| number_of(cell).is_some()) {
            return Ok(Some(Head { names: cells, separator, body: number + 1 }));
        }
        let Some((above, names)) = comment else {
            return Err(Error::NoNames { path: path.to_owned(), line: number as u64 + 1 });
        };
        let names = fields(path, above as u64 + 1, names, separator)?;
        if names.len() != cells.len() {
            return Err(Error::NoNames { path: path.to_owned(), line: number as u64 + 1 });
        }
        return Ok(Some(Head { names, separator, body: number }));
    }
    Ok(None)
}

fn is_comment(line: &str) -> bool {
    line.trim_start().starts_with(['#', '%'])
}

fn separator(line: &str) -> char {
    SEPARATORS.into_iter().find(|separator| line.contains(*separator)).unwrap_or(' ')
}

/// The fields of a line, without quotes and blanks around them.
fn fields(path: &Path, line: u64, text: &str, separator: char) -> Result<Vec<String>, Error> {
    if separator == ' ' {
        return Ok(text.split_whitespace().map(str::to_owned).collect());
    }
    match reader(text, separator).records().next() {
        // quotes behind a blank are no quotes to the reader
        Some(Ok(record)) => {
            Ok(record.iter().map(|field| field.trim_matches('"').to_owned()).collect())
        }
        Some(Err(error)) => Err(unparsable(path, line, &error)),
        None => Ok(Vec::new()),
    }
}

/// The number in a cell; an empty cell is a missing value, NaN. Fortran's `1.5D-3` is a number.
fn number_of(cell: &str) -> Option<f64> {
    if cell.is_empty() {
        return Some(f64::NAN);
    }
    cell.parse().ok().or_else(|| {
        let numeric = |c: char| c.is_ascii_digit() || "+-.dD".contains(c);
        cell.chars().all(numeric).then(|| cell.replace(['d', 'D'], "e").parse().ok()).flatten()
    })
}

impl ForeignColumn {
    /// Adds a cell.
    fn add(&mut self, line: u64, cell: &str) {
        let number = number_of(cell);
        if number.is_none() && self.text.is_none() {
            self.text = Some(Misplaced { line, text: cell.to_owned() });
        }
        self.values.push(number.unwrap_or(f64::NAN));
        let digits = significant_digits(cell);
        self.written_digits = self.written_digits.map(|most| most.max(digits));
    }
}

/// Significant digits that a number is written with: those from the first that is not zero on.
fn significant_digits(cell: &str) -> usize {
    let mantissa = cell.split(['e', 'E', 'd', 'D']).next().unwrap_or_default();
    let digits = mantissa.chars().filter(char::is_ascii_digit);
    digits.skip_while(|digit| *digit == '0').count()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str) -> ForeignTable {
        read(Path::new("theirs.csv"), text).unwrap()
    }

    fn complaint(text: &str) -> String {
        read(Path::new("theirs.csv"), text).unwrap_err().to_string()
    }

    #[test]
    fn every_usual_separator_gives_the_same_columns() {
        for text in [
            "t,phi\n0,1\n0.5,-2e-3\n",
            "t;phi\n0;1\n0.5;-2e-3\n",
            "t\tphi\n0\t1\n0.5\t-2e-3\n",
            "  t   phi\n 0  1\n 0.5  -2e-3\n",
            "\u{feff}\"t\" , \"phi\"\r\n\r\n0 , 1\r\n0.5 , -2.0D-03\r\n",
            "# run 7\n# t, phi\n0, 1\n0.5, -2e-3\n",
            "% t phi\n0 1\n% a remark\n0.5 -2e-3\n",
        ] {
            let table = table(text);
            let names: Vec<&str> = table.columns.iter().map(|c| c.name.as_str()).collect();
            assert_eq!(names, ["t", "phi"], "{text:?}");
            assert_eq!(table.columns[0].values, [0.0, 0.5], "{text:?}");
            assert_eq!(table.columns[1].values, [1.0, -2e-3], "{text:?}");
            assert!(!table.ends_within_a_line);
        }
    }

    #[test]
    fn a_table_without_names_is_refused() {
        let complaint = complaint("0,1\n0.5,2\n");
        assert!(complaint.contains("line 1") && complaint.contains("names"), "{complaint}");
    }

    #[test]
    fn a_line_that_is_cut_short_is_told_by_its_number() {
        for text in ["t,phi\n0,1\n\n# remark, of two\n0.5\n", "t phi\n0 1\n\n% remark\n0.5\n"] {
            let complaint = complaint(text);
            assert!(complaint.contains("line 5"), "{complaint}");
        }
    }

    #[test]
    fn text_without_rows_is_empty() {
        for text in ["t,phi\n", "# nothing\n", "\n\n"] {
            assert!(complaint(text).contains("no rows"), "{text:?}");
        }
    }

    #[test]
    fn words_are_remembered_where_they_stand_and_gaps_are_missing_values() {
        let table = table("t,phi,remark\n0,1,begin\n\n0.5,,\n");
        let [_, phi, remark] = &table.columns[..] else { panic!("three columns") };
        assert!(phi.values[1].is_nan() && phi.text.is_none());
        assert_eq!(remark.text, Some(Misplaced { line: 2, text: "begin".into() }));
    }

    #[test]
    fn decimals_of_a_column_are_counted() {
        let table = table("t,phi\n0,0.0012345\n1e-5,-1.2e3\n");
        let digits: Vec<_> = table.columns.iter().map(|c| c.written_digits.unwrap()).collect();
        assert_eq!(digits, [1, 5]);
    }

    #[test]
    fn a_file_that_ends_within_a_line_is_noticed() {
        assert!(table("t,phi\n0,1\n0.5,2.3").ends_within_a_line);
    }

    proptest::proptest! {
        #[test]
        fn any_text_is_read_or_refused(text in "([a-z#%;,\t\" .0-9é-]{0,12}\r?\n?){0,6}") {
            if let Ok(table) = read(Path::new("theirs.csv"), &text) {
                let rows = table.columns[0].values.len();
                assert!(table.columns.iter().all(|column| column.values.len() == rows));
            }
        }
    }
}
