//! Derivations and verdicts, as plain data of Python.

use std::collections::BTreeMap;

use dalembert_codegen::claims::{Finding, Verdict};
use dalembert_codegen::read;
use dalembert_codegen::report::certificate::Tree;
use dalembert_codegen::report::{Item, Report, report, report_without_claims};
use dalembert_codegen::spec::{Declaration, Spec};
use dalembert_codegen::tables::text_of;
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::error::{named, refused};

/// The derivations of a model and of its scenes, from its source: one dictionary each.
#[pyfunction]
pub fn derive<'py>(py: Python<'py>, source: &str, claims: bool) -> PyResult<Bound<'py, PyList>> {
    let derived = py.detach(|| {
        let derived = match claims {
            true => report(source),
            false => report_without_claims(source),
        };
        derived.map_err(|error| error.to_string())
    });
    let derived = derived.map_err(refused)?;
    let all = core::iter::once(&derived).chain(&derived.scenes);
    let all: PyResult<Vec<_>> = all.map(|report| derivation(py, report)).collect();
    PyList::new(py, all?)
}

fn derivation<'py>(py: Python<'py>, report: &Report) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("name", &report.name)?;
    dict.set_item("documentation", &report.documentation)?;
    dict.set_item("text", report.text())?;
    dict.set_item("latex", report.latex())?;
    let sections = report.sections.iter().map(|section| {
        let items: PyResult<Vec<_>> = section.items.iter().map(|it| item(py, it)).collect();
        Ok((section.title, section.equation, items?))
    });
    dict.set_item("sections", sections.collect::<PyResult<Vec<_>>>()?)?;
    let findings: PyResult<Vec<_>> = report.findings.iter().map(|it| finding(py, it)).collect();
    dict.set_item("findings", findings?)?;
    dict.set_item("declaration", tree(py, &report.certificate)?)?;
    Ok(dict)
}

/// A line: text, or a left side and rows of entries, each as text and as LaTeX.
fn item<'py>(py: Python<'py>, item: &Item) -> PyResult<Bound<'py, PyAny>> {
    match item {
        Item::Words(words) => words.into_bound_py_any(py),
        Item::Formula { left, right } => (left, vec![vec![right]]).into_bound_py_any(py),
        Item::Matrix { left, rows } => (left, rows).into_bound_py_any(py),
    }
}

/// The arguments of the Python class `Verdict`, except the scene.
fn finding<'py>(py: Python<'py>, finding: &Finding) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("claim", &finding.claim)?;
    dict.set_item("verdict", finding.word())?;
    dict.set_item("grounds", finding.grounds())?;
    dict.set_item("remarks", &finding.remarks)?;
    if let Some(counterexample) = finding.counterexample() {
        dict.set_item("counterexample", named(py, &counterexample.at)?)?;
        dict.set_item("values", named(py, &counterexample.values)?)?;
    }
    if let Verdict::Proved(certificate) = &finding.verdict {
        dict.set_item("chance_of_error", certificate.error)?;
    }
    Ok(dict)
}

fn tree<'py>(py: Python<'py>, node: &Tree) -> PyResult<Bound<'py, PyAny>> {
    match node {
        Tree::Absent => Ok(py.None().into_bound(py)),
        Tree::Flag(flag) => flag.into_bound_py_any(py),
        Tree::Number(number) => number.into_bound_py_any(py),
        Tree::Integer(integer) => integer.into_bound_py_any(py),
        Tree::Text(text) => text.into_bound_py_any(py),
        Tree::List(values) => {
            let values: PyResult<Vec<_>> = values.iter().map(|it| tree(py, it)).collect();
            values?.into_bound_py_any(py)
        }
        Tree::Record(entries) => {
            let dict = PyDict::new(py);
            for (name, value) in entries {
                dict.set_item(name, tree(py, value)?)?;
            }
            Ok(dict.into_any())
        }
    }
}

/// The doc comments of coordinates and parameters, by name.
#[pyfunction]
pub fn documentation(source: &str) -> PyResult<BTreeMap<String, String>> {
    let tokens = source
        .parse()
        .map_err(|error| refused(format!("{error}")))?;
    let mistakes = |_| refused("a declaration that was loaded is not read again");
    let specs: Vec<Spec> = match read(tokens).map_err(mistakes)? {
        Declaration::Model(spec) => vec![*spec],
        Declaration::Modes(modes) => modes.modes.into_iter().map(|mode| mode.spec).collect(),
    };
    let mut found = BTreeMap::new();
    for spec in &specs {
        let parameters = spec
            .parameters
            .iter()
            .map(|it| (&it.declared.name, &it.documentation));
        let coordinates = spec
            .coordinates
            .iter()
            .map(|it| (&it.declared.name, &it.documentation));
        for (name, documentation) in coordinates.chain(parameters) {
            let text = text_of(documentation);
            if !text.is_empty() {
                found.insert(name.text.clone(), text);
            }
        }
    }
    Ok(found)
}
