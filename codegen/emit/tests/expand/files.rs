//! Expansion of the models of a file.

use dalembert_emit::expand_file;

const ONE: &str = "/// A ball.\nBall { coordinates { x; } lagrangian = dot(x)^2; }\n";
const OTHER: &str = "pub Disk { coordinates { y; } lagrangian = dot(y)^2; }";

/// Items or errors of a file with this text.
fn expanded(name: &str, text: &str) -> String {
    let folder = std::env::temp_dir().join(format!("dalembert-file-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    std::fs::write(folder.join(name), text).expect("a file");
    let literal = format!("{name:?}").parse().expect("a literal");
    expand_file(literal, &folder).to_string()
}

#[test]
fn the_models_of_a_file_are_expanded() {
    let both = expanded("both.dal", &format!("{ONE}{OTHER}"));
    assert!(both.contains("struct Ball") && both.contains("struct Disk"));
    assert!(both.contains("include_bytes"));
    let one = expanded("one.dal", ONE);
    let source = format!(
        "source : :: dalembert :: erased :: Held :: Static ({:?})",
        ONE.trim()
    );
    assert!(one.contains(&source), "{one}");
}

#[test]
fn mistakes_in_a_file_are_reported() {
    let unknown = expanded(
        "unknown.dal",
        "Ball { coordinates { x; } lagrangian = dot(x)^2 - k*x; }",
    );
    assert!(
        unknown.contains("unknown name `k`") && unknown.contains("unknown.dal` shows the place")
    );
    assert!(expanded("empty.dal", "// nothing").contains("no model here"));
    assert!(expanded("open.dal", "Ball { coordinates").contains("not a text of the language"));
    let folder = std::env::temp_dir();
    let expand = |text: &str| expand_file(text.parse().expect("tokens"), &folder).to_string();
    assert!(expand("\"no/such.dal\"").contains("cannot be read"));
    assert!(expand("no").contains("expected the path of a file"));
}
