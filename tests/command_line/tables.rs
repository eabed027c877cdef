//! Tables that commands write.

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
