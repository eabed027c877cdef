//! `cost { running = u^2/2; terminal = a*(x - 1)^2; }`: the quantity that optimal inputs minimise.

use super::super::ast::{Cost, Spec, Word};
use super::super::cursor::{Cursor, Read};
use super::documentation;
use super::target::equals;

const FORM: &str = "running = u^2/2;";

/// Records that a cost is declared, even if it is empty.
pub(super) fn begin(keyword: &Word, spec: &mut Spec) {
    if spec.cost.is_none() {
        let item = spec.item(keyword.at);
        spec.cost = Some(Cost {
            running: None,
            terminal: None,
            item,
        });
    }
}

/// Reads one entry.
pub(super) fn entry(cursor: &mut Cursor<'_>, spec: &mut Spec) -> Read<()> {
    documentation(cursor)?;
    let key = cursor.name("`running` or `terminal`")?;
    if !["running", "terminal"].contains(&key.text.as_str()) {
        let text = format!("unknown entry `{}` of `cost`", key.text);
        let help = "a cost is written `running = u^2/2;` and `terminal = (x - 1)^2;`; bounds on states and inputs are not supported";
        return Err(cursor.refuse(key.at, text, help));
    }
    equals(cursor, FORM)?;
    let value = cursor.scalar()?;
    let Some(cost) = &mut spec.cost else {
        return Ok(());
    };
    let place = match key.text.as_str() {
        "running" => &mut cost.running,
        _ => &mut cost.terminal,
    };
    if place.replace(value).is_some() {
        let text = format!("`{}` declared again", key.text);
        cursor.refuse(key.at, text, "keep one of the two");
    }
    Ok(())
}
