//! Rows written as Parquet and read back.

use ::parquet::file::reader::{FileReader, SerializedFileReader};
use ::parquet::record::Field;

use super::*;

#[test]
fn parquet_holds_the_rows_of_the_table() {
    let folder = Folder::new("parquet");
    let line = format!("{BALLS} --parquet {}", folder.path("rows.parquet"));
    let done = run(&line);
    assert_eq!(done.exit, Exit::Other, "{}", done.errors);
    let written = fs::read(folder.0.join("rows.parquet")).unwrap();
    // No other file is left. With `--csv` as well, the Parquet file is the same.
    assert_eq!(fs::read_dir(&folder.0).unwrap().count(), 1);
    run(&format!("{line} --csv {}", folder.path("rows.csv")));
    assert_eq!(fs::read(folder.0.join("rows.parquet")).unwrap(), written);

    let file = fs::File::open(folder.0.join("rows.parquet")).unwrap();
    let reader = SerializedFileReader::new(file).unwrap();
    let metadata = reader
        .metadata()
        .file_metadata()
        .key_value_metadata()
        .unwrap();
    let entry = |key: &str| {
        let found = metadata.iter().find(|entry| entry.key == key);
        found.and_then(|entry| entry.value.clone()).unwrap()
    };
    assert_eq!(entry("dalembert.model"), "bouncing_ball");
    assert_eq!(entry("dalembert.tol"), "1e-10");
    assert_eq!(entry("dalembert.model_hash").len(), 16);

    let mut table = csv::Reader::from_path(folder.0.join("rows.csv")).unwrap();
    let header: Vec<String> = table.headers().unwrap().iter().map(str::to_owned).collect();
    let mut rows = reader.get_row_iter(None).unwrap();
    for record in table.records() {
        let row = rows.next().unwrap().unwrap();
        for (index, (name, field)) in row.get_column_iter().enumerate() {
            assert_eq!(*name, header[index]);
            let text = match field {
                Field::ULong(value) => value.to_string(),
                Field::Double(value) => format!("{value:?}"),
                Field::Str(text) => text.clone(),
                other => panic!("{name}: {other}"),
            };
            assert_eq!(text, record.as_ref().unwrap()[index], "{name}");
        }
    }
    assert!(rows.next().is_none());
}

#[test]
fn parquet_is_made_of_what_is_continued() {
    let folder = Folder::new("parquet-resume");
    let line = format!("{BALLS} --parquet {}", folder.path("rows.parquet"));
    run(&line);
    let whole = fs::read(folder.0.join("rows.parquet")).unwrap();
    // An interrupted run leaves some rows and no Parquet file.
    run(&format!(
        "{BALLS} --csv {}",
        folder.path("rows.parquet.rows.csv")
    ));
    let rows = folder.read("rows.parquet.rows.csv");
    let torn = &rows.as_bytes()[..rows.len() / 2];
    fs::write(folder.0.join("rows.parquet.rows.csv"), torn).unwrap();
    fs::remove_file(folder.0.join("rows.parquet")).unwrap();
    let done = run(&format!("{line} --resume"));
    assert!(done.output.contains("taken over"), "{}", done.output);
    assert_eq!(fs::read(folder.0.join("rows.parquet")).unwrap(), whole);
}
