//! Tables that commands write.

use dalembert_cli::Exit;

use crate::run;

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

/// Names of the language stand for the names of columns, and give the same files.
#[test]
fn quantities_have_their_names_in_the_language() {
    let oscillator = "simulate oscillator --until 1 --set k=2 --samples 3 --csv -";
    for [column, language] in [
        [
            format!("{oscillator} --initial x.2=0.5,x_dot.1=0.25"),
            format!("{oscillator} --initial x[2]=0.5,dot(x[1])=0.25"),
        ],
        [
            "ensemble bouncing_ball --vary x_dot=0..1:3 --until 2 --csv - --density x_dot=-9..9,energy:3".to_owned(),
            "ensemble bouncing_ball --vary dot(x)=0..1:3 --until 2 --csv - --density dot(x)=-9..9,energy:3".to_owned(),
        ],
        [
            "map bouncing_ball --vary x_dot=0..1:3 --until 1 --csv -".to_owned(),
            "map bouncing_ball --vary dot(x)=0..1:3 --until 1 --csv -".to_owned(),
        ],
    ] {
        let [column, language] = [column, language].map(|line| run(&line));
        assert_eq!(column.exit, Exit::Reached, "{}", column.errors);
        assert_eq!(language.output, column.output, "{}", language.errors);
    }
    let unknown = run("simulate bouncing_ball --initial dot(y)=1");
    assert!(unknown.errors.contains("`dot(y)`"), "{}", unknown.errors);
}
