//! Parquet: the table that the CSV file holds.
#![cfg(feature = "parquet")]

mod synthetic;

use std::fs::File;

use flank_export::{Dataset, write_csv, write_parquet};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use synthetic::{bevel, dataset, gallery, holes, plane, with_fields, without};

fn table(dataset: &Dataset) -> SerializedFileReader<File> {
    let mut file = tempfile::tempfile().expect("a file");
    write_parquet(&dataset.surfaces(), &mut file).expect("a sound dataset");
    SerializedFileReader::new(file).expect("a Parquet file")
}

/// All cells as the CSV file would have them.
fn cells(dataset: &Dataset) -> Vec<Vec<(String, String)>> {
    let cell = |field: &Field| match field {
        Field::Null => String::new(),
        Field::Str(text) => text.clone(),
        Field::Int(number) => number.to_string(),
        Field::Double(number) => format!("{number:?}").trim_end_matches(".0").to_owned(),
        other => panic!("{other:?}"),
    };
    let row =
        |row: parquet::record::Row| row.get_column_iter().map(|(title, field)| (title.clone(), cell(field))).collect();
    table(dataset).get_row_iter(None).expect("rows").map(|found| row(found.expect("a row"))).collect()
}

fn from_csv(dataset: &Dataset) -> Vec<Vec<(String, String)>> {
    let mut file = Vec::new();
    write_csv(&dataset.surfaces(), &mut file).expect("a sound dataset");
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(file.as_slice());
    let titles = reader.headers().expect("titles").clone();
    let row =
        |record: csv::StringRecord| titles.iter().map(String::from).zip(record.iter().map(String::from)).collect();
    reader.records().map(|record| row(record.expect("a record"))).collect()
}

#[test]
fn the_cells_are_those_of_the_csv_file() {
    let mut datasets: Vec<Dataset> = gallery().into_iter().map(|(_, dataset)| dataset).collect();
    datasets.push(dataset("job", vec![with_fields(without(bevel([5, 4]), holes)), plane([3, 3], [0.0; 3], 5.0)]));
    for dataset in datasets {
        assert_eq!(cells(&dataset), from_csv(&dataset), "{}", dataset.header.job);
    }
}

#[test]
fn the_file_says_what_its_columns_are() {
    let dataset = dataset("job", vec![with_fields(bevel([5, 4]))]);
    let table = table(&dataset);
    let facts = table.metadata().file_metadata().key_value_metadata().expect("facts");
    let fact = |key: &str| facts.iter().find(|fact| fact.key == key).and_then(|fact| fact.value.clone()).expect("told");
    assert_eq!(fact("unknown phi"), "deg");
    assert!(fact("field k1").starts_with("1/mm: "));
    assert!(fact("conventions").contains("lengths in mm"));
    assert!(fact("surface concave flank").contains("solved 20 of 20 asked"), "{}", fact("surface concave flank"));
}
