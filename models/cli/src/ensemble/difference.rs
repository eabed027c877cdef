//! Differences between the metadata of a file and those of a request, with the flags that the file was made with.

use serde_json::{Map, Value};

/// Parts of an explanation of one difference: the changed quantity, and the flags that restore it.
struct Difference {
    change: String,
    remedy: String,
}

/// Names all keys of `metadata` whose values differ from those of `before`, and the flags to give; `None` if there are
/// none. An absent key counts as `null`, because older files lack keys of newer flags.
pub fn explain(before: &Map<String, Value>, metadata: &Map<String, Value>) -> Option<String> {
    let mut differences = Vec::new();
    for (key, value) in metadata {
        let was = before.get(key).unwrap_or(&Value::Null);
        if was != value {
            compare(key, was, value, &mut differences);
        }
    }
    let join = |part: fn(&Difference) -> &str, between: &str| {
        let mut parts: Vec<&str> = differences.iter().map(part).collect();
        parts.dedup();
        parts.join(between)
    };
    (!differences.is_empty()).then(|| {
        format!(
            "{}; {}",
            join(|it| &it.change, ", "),
            join(|it| &it.remedy, ", ")
        )
    })
}

/// Adds the differences of one key. Objects whose members stand for flags of their own are compared by member.
fn compare(key: &str, was: &Value, value: &Value, differences: &mut Vec<Difference>) {
    match (key, was, value) {
        // The key `model_hash` differs too and is reported.
        ("model_source", ..) => {}
        (
            "parameters" | "start" | "q" | "qdot" | "p" | "map",
            Value::Object(old),
            Value::Object(new),
        ) => {
            let removed = old.keys().filter(|name| !new.contains_key(*name));
            for name in new.keys().chain(removed) {
                let [was, value] = [old, new].map(|it| it.get(name).unwrap_or(&Value::Null));
                if was == value {
                    continue;
                }
                match key {
                    "start" => compare(name, was, value, differences),
                    "map" => differences.push(flag(name, was, value)),
                    _ => differences.push(component(key, name, [was, value])),
                }
            }
        }
        ("members", Value::Object(_), Value::Object(_)) => {
            let [old, new] = [was, value];
            let drawn = !old["seed"].is_null() && !new["seed"].is_null();
            let same = |key: &str| old[key] == new[key];
            match same("varied") && drawn {
                true => {
                    for (key, flag) in [("seed", "random"), ("count", "members")] {
                        if !same(key) {
                            differences.push(Difference {
                                change: changed(key, &old[key], &new[key]),
                                remedy: format!("give --{flag} {}", old[key]),
                            });
                        }
                    }
                }
                false => differences.push(flag(key, was, value)),
            }
        }
        _ => differences.push(flag(key, was, value)),
    }
}

/// The difference of a parameter, or of a component of the start.
fn component(key: &str, name: &str, [was, value]: [&Value; 2]) -> Difference {
    let name = match key {
        "qdot" => crate::names::velocity(name),
        "p" => crate::names::momentum(name),
        _ => name.to_owned(),
    };
    Difference {
        change: changed(&name, was, value),
        remedy: match (key, was) {
            ("p", _) => "give the momenta of the file by --p".to_owned(),
            ("parameters", Value::Null) => format!("leave `{name}` out of --set"),
            (_, Value::Null) => format!("leave `{name}` out of --initial"),
            ("parameters", was) => format!("give --set {name}={was}"),
            (_, was) => format!("give --initial {name}={was}"),
        },
    }
}

/// The difference of the value of a flag.
fn flag(key: &str, was: &Value, value: &Value) -> Difference {
    let flag = format!("--{}", spelled(key));
    let remedy = match (key, was) {
        ("version", _) => "use the version that made the file".to_owned(),
        ("model" | "model_hash", _) => {
            "give the model that the file was made with, and the same --feedback and --output"
                .to_owned()
        }
        (_, Value::Null) => format!("leave out {flag}"),
        (_, was) => match flags(key, &flag, was) {
            Some(flags) => format!("give {flags}"),
            None => format!("give the {flag} that the file was made with"),
        },
    };
    Difference {
        change: changed(key, was, value),
        remedy,
    }
}

/// The change in words: both values if they are short, as in "`until` was 6.0 and is 7.0"; otherwise only that they
/// differ, or that one of them is absent.
fn changed(key: &str, was: &Value, value: &Value) -> String {
    let is_short = |value: &Value| !matches!(value, Value::Object(_) | Value::Array(_));
    match (was, value) {
        (Value::Null, value) if !is_short(value) => format!("`{key}` was absent and is given"),
        (was, Value::Null) if !is_short(was) => format!("`{key}` was given and is absent"),
        (was, value) if is_short(was) && is_short(value) => {
            let told = |value: &Value| match value {
                Value::Null => "absent".to_owned(),
                value => value.to_string(),
            };
            format!("`{key}` was {} and is {}", told(was), told(value))
        }
        _ => format!("`{key}` differs"),
    }
}

/// The flag of a key, without its dashes.
fn spelled(key: &str) -> String {
    match key {
        "members" => "vary".to_owned(),
        "laws" => "law".to_owned(),
        "outputs" => "output".to_owned(),
        "contours" => "contour".to_owned(),
        key => key.replace('_', "-"),
    }
}

/// The flags that give a value; `None` if the value does not determine them.
fn flags(key: &str, flag: &str, value: &Value) -> Option<String> {
    match (key, value) {
        ("density", value) => density(value),
        ("members", value) => members(value),
        ("laws", Value::Array(laws)) => repeated(laws, |law| {
            let [surface, law] = ["surface", "law"].map(|key| law[key].as_str());
            Some(format!("--law {}={}", surface?, law?))
        }),
        ("projection", Value::Bool(is_on)) => {
            Some(format!("{flag} {}", if *is_on { "on" } else { "off" }))
        }
        (_, Value::Array(texts)) => {
            repeated(texts, |text| Some(format!("{flag} '{}'", text.as_str()?)))
        }
        (_, Value::String(text)) => Some(format!("{flag} {}", quoted(text))),
        (_, Value::Number(number)) => Some(format!("{flag} {number}")),
        _ => None,
    }
}

/// A text in quotes, if a shell would split it.
fn quoted(text: &str) -> String {
    let is_plain =
        |character: char| character.is_ascii_alphanumeric() || "_.:=/-".contains(character);
    match text.chars().all(is_plain) {
        true => text.to_owned(),
        false => format!("'{text}'"),
    }
}

/// One flag for each of several values.
fn repeated(values: &[Value], flag: impl Fn(&Value) -> Option<String>) -> Option<String> {
    let flags: Option<Vec<String>> = values.iter().map(flag).collect();
    flags
        .filter(|flags| !flags.is_empty())
        .map(|flags| flags.join(" "))
}

/// The flags of a density.
fn density(value: &Value) -> Option<String> {
    let axes = value["axes"].as_array()?;
    let named: Option<Vec<String>> = axes
        .iter()
        .map(|axis| {
            let [low, high] = [0, 1].map(|end| &axis["range"][end]);
            Some(format!("{}={low}..{high}", axis["name"].as_str()?))
        })
        .collect();
    let bins: Vec<String> = axes.iter().map(|axis| axis["bins"].to_string()).collect();
    Some(format!(
        "--density {}:{} --every {} --discard {}",
        named?.join(","),
        bins.join("x"),
        value["every"],
        value["discard"]
    ))
}

/// The flags of members.
fn members(value: &Value) -> Option<String> {
    if value.get("listed").is_some() {
        return Some("--from with the table that the file was made from".to_owned());
    }
    let varied = repeated(value["varied"].as_array()?, |it| {
        let name = it["name"].as_str()?;
        let range = |key: &str| Some([it.get(key)?.get(0)?, it.get(key)?.get(1)?]);
        let values = if let Some([low, high]) = range("ends") {
            format!("{low}..{high}:{}", it["count"])
        } else if let Some([low, high]) = range("uniform") {
            format!("{low}..{high}")
        } else if let Some(values) = it.get("values").and_then(Value::as_array) {
            let values: Vec<String> = values.iter().map(Value::to_string).collect();
            values.join(",")
        } else {
            format!("{}+-{}", it["mean"], it["deviation"])
        };
        Some(format!("--vary {name}={values}"))
    });
    match &value["seed"] {
        Value::Null => varied,
        seed => Some(format!(
            "--random {seed} --members {} {}",
            value["count"], varied?
        )),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn explained(before: Value, metadata: Value) -> Option<String> {
        let [Value::Object(before), Value::Object(metadata)] = [before, metadata] else {
            panic!("both are objects");
        };
        explain(&before, &metadata)
    }

    #[test]
    fn flags_to_give_are_named() {
        let counted = json!({
            "axes": [{ "name": "x", "range": [-1.0, 1.0], "bins": 20 }, { "name": "y", "range": [0.0, 0.5], "bins": 30 }],
            "every": 0.25, "discard": 0.0,
        });
        let drawn = json!({ "count": 8, "varied": [{ "name": "x", "mean": 0.5, "deviation": 0.1 }], "seed": 7 });
        let other = json!({ "count": 9, "varied": [{ "name": "x", "mean": 0.5, "deviation": 0.1 }], "seed": 8 });
        let grid = json!({ "count": 3, "varied": [{ "name": "x", "ends": [0.0, 1.0], "count": 3 }], "seed": null });
        let cases = [
            (
                json!({ "density": counted }),
                json!({ "density": null }),
                "`density` was given and is absent; give --density x=-1.0..1.0,y=0.0..0.5:20x30 --every 0.25 --discard 0.0",
            ),
            (
                json!({}),
                json!({ "density": counted }),
                "`density` was absent and is given; leave out --density",
            ),
            (
                json!({ "until": 6.0, "max_step": null }),
                json!({ "until": 7.0, "max_step": 0.5 }),
                "`until` was 6.0 and is 7.0, `max_step` was absent and is 0.5; give --until 6.0, leave out --max-step",
            ),
            (
                json!({ "members": drawn }),
                json!({ "members": other }),
                "`seed` was 7 and is 8, `count` was 8 and is 9; give --random 7, give --members 8",
            ),
            (
                json!({ "members": drawn }),
                json!({ "members": grid }),
                "`members` differs; give --random 7 --members 8 --vary x=0.5+-0.1",
            ),
            (
                json!({ "members": grid }),
                json!({ "members": drawn }),
                "`members` differs; give --vary x=0.0..1.0:3",
            ),
            (
                json!({ "parameters": { "m": 1.0, "g": 2.0 }, "start": { "q": { "x": 1.0 }, "qdot": { "x": 3.0 } } }),
                json!({ "parameters": { "m": 2.0, "g": 2.0 }, "start": { "q": { "x": 1.0 }, "qdot": {} } }),
                "`m` was 1.0 and is 2.0, `x_dot` was 3.0 and is absent; give --set m=1.0, give --initial x_dot=3.0",
            ),
            (
                json!({ "laws": [{ "surface": "floor", "law": "newton:0.5" }] }),
                json!({ "laws": [] }),
                "`laws` differs; give --law floor=newton:0.5",
            ),
            (
                json!({ "map": { "returns": 10, "fail": "x > 1" } }),
                json!({ "map": { "returns": 20, "fail": null } }),
                "`returns` was 10 and is 20, `fail` was \"x > 1\" and is absent; give --returns 10, give --fail 'x > 1'",
            ),
        ];
        for (before, metadata, expected) in cases {
            assert_eq!(explained(before, metadata).as_deref(), Some(expected));
        }
        assert_eq!(
            explained(
                json!({ "until": 6.0 }),
                json!({ "until": 6.0, "map": null })
            ),
            None
        );
    }
}
