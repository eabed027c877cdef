//! Files and tables that commands write.

use std::fs;
use std::path::PathBuf;

/// A folder for files, removed at the end.
pub struct Folder(PathBuf);

impl Folder {
    pub fn new(name: &str) -> Self {
        let folder = format!("dalembert-{name}-{}", std::process::id());
        let path = std::env::temp_dir().join(folder);
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    pub fn path(&self, name: &str) -> String {
        self.0.join(name).display().to_string()
    }

    pub fn read(&self, name: &str) -> String {
        fs::read_to_string(self.0.join(name)).unwrap()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        fs::remove_dir_all(&self.0).unwrap();
    }
}

/// A column of a table in CSV.
pub fn column(table: &str, name: &str) -> Vec<String> {
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let place = reader.headers().unwrap().iter().position(|it| it == name);
    let place = place.unwrap_or_else(|| panic!("no column {name} in {table}"));
    let records = reader.records().map(Result::unwrap);
    records.map(|record| record[place].to_owned()).collect()
}

pub fn numbers_of(table: &str, name: &str) -> Vec<f64> {
    let column = column(table, name);
    column.iter().map(|text| text.parse().unwrap()).collect()
}
