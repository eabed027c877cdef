//! `claims { density: exact; volume: kept; conserved: energy; symmetry: partial(theta); }`

use super::super::ast::{Claim, Existence, Scalar, Spec, Statement};
use super::super::cursor::{Cursor, Read};
use super::declared;
use crate::diagnostics::{Location, listed, nearest};

const KINDS: [&str; 11] = [
    "density",
    "conserved",
    "not",
    "symmetry",
    "invariant",
    "involution",
    "integrable",
    "volume",
    "symplectic",
    "energy",
    "assume",
];
const EXISTENCE: [(&str, Existence); 3] = [
    ("exact", Existence::Global),
    ("locally_exact", Existence::Local),
    ("none", Existence::None),
];
const EXISTENCES: &str = "`exact`, `locally_exact` or `none`";

/// Reads one claim.
pub(super) fn claim(cursor: &mut Cursor<'_>, spec: &mut Spec) -> Read<()> {
    super::documentation(cursor)?;
    let start = cursor.here();
    let is_assumed = cursor.eat_word("assume");
    let statement = match cursor.eat_word("not") {
        true => {
            expect_word(cursor, "conserved", "not conserved: energy;")?;
            conserved(cursor, false)?
        }
        false => {
            let kind = cursor.name("a claim")?;
            match kind.text.as_str() {
                "density" => density(cursor)?,
                "conserved" => conserved(cursor, true)?,
                "symmetry" => symmetry(cursor)?,
                "invariant" => invariant(cursor)?,
                "involution" => {
                    Statement::Involution(quantities(cursor, "involution: energy, momentum(x);")?)
                }
                "integrable" => {
                    Statement::Integrable(quantities(cursor, "integrable: energy, momentum(x);")?)
                }
                "volume" => volume(cursor)?,
                "symplectic" => Statement::Symplectic,
                "energy" => energy(cursor)?,
                unknown => {
                    let help = match nearest(unknown, KINDS) {
                        Some(near) => format!("did you mean `{near}`?"),
                        None => format!("claims begin with {}", listed(KINDS)),
                    };
                    let text = format!("unknown claim `{unknown}`");
                    return Err(cursor.refuse(kind.at, text, &help));
                }
            }
        }
    };
    let item = spec.item(start.to(cursor.last()));
    spec.claims.push(Claim {
        statement,
        is_assumed,
        scene: None,
        item,
    });
    Ok(())
}

/// `volume: kept`, after the first word.
fn volume(cursor: &mut Cursor<'_>) -> Read<Statement> {
    const FORM: &str = "volume: kept;";
    cursor.expect_operator(":", FORM)?;
    expect_word(cursor, "kept", FORM)?;
    Ok(Statement::VolumeKept)
}

/// `energy under surface: not increasing`, after the first word.
fn energy(cursor: &mut Cursor<'_>) -> Read<Statement> {
    const FORM: &str = "energy under wall: not increasing;";
    expect_word(cursor, "under", FORM)?;
    let under = declared(cursor, "the name of a surface")?;
    cursor.expect_operator(":", FORM)?;
    expect_word(cursor, "not", FORM)?;
    expect_word(cursor, "increasing", FORM)?;
    Ok(Statement::EnergyNotIncreasing(under))
}

/// `density under surface: factor = e`, after the first two words.
fn factor(cursor: &mut Cursor<'_>) -> Read<Statement> {
    const FORM: &str = "density under wall: factor = e^2;";
    let under = declared(cursor, "the name of a surface")?;
    cursor.expect_operator(":", FORM)?;
    expect_word(cursor, "factor", FORM)?;
    cursor.expect_operator("=", FORM)?;
    let value = cursor.scalar()?;
    Ok(Statement::Factor { under, value })
}

/// `density: exact`, `density = e` or `density under surface: factor = e`
fn density(cursor: &mut Cursor<'_>) -> Read<Statement> {
    if cursor.eat_word("under") {
        return factor(cursor);
    }
    if cursor.eat_operator("=").is_some() {
        return Ok(Statement::Density(cursor.scalar()?));
    }
    cursor.expect_operator(":", "density: exact;")?;
    let word = cursor.name(EXISTENCES)?;
    let known = EXISTENCE.iter().find(|(name, _)| *name == word.text);
    match known {
        Some((_, existence)) => Ok(Statement::Existence(*existence)),
        None => {
            let text = format!("expected {EXISTENCES}, found `{}`", word.text);
            Err(cursor.refuse(word.at, text, "a stated density is written `density = ..;`"))
        }
    }
}

/// `conserved: e` or `conserved under surface: e`, after the first word.
fn conserved(cursor: &mut Cursor<'_>, holds: bool) -> Read<Statement> {
    let under = match cursor.eat_word("under") {
        true => Some(declared(cursor, "the name of a surface")?),
        false => None,
    };
    cursor.expect_operator(":", "conserved: energy;")?;
    Ok(Statement::Conserved {
        value: cursor.scalar()?,
        under,
        holds,
    })
}

/// `symmetry: partial(theta) - y*partial(x)`, after the first word.
fn symmetry(cursor: &mut Cursor<'_>) -> Read<Statement> {
    cursor.expect_operator(":", "symmetry: partial(theta);")?;
    Ok(Statement::Symmetry(cursor.scalar()?))
}

/// `invariant: d(x)^d(dot(x))`, after the first word.
fn invariant(cursor: &mut Cursor<'_>) -> Read<Statement> {
    cursor.expect_operator(":", "invariant: d(x)^d(dot(x));")?;
    Ok(Statement::Invariant(cursor.scalar()?))
}

/// `: f, g, ..`
fn quantities(cursor: &mut Cursor<'_>, form: &str) -> Read<Vec<Scalar>> {
    cursor.expect_operator(":", form)?;
    let mut quantities = vec![cursor.scalar()?];
    while cursor.eat_operator(",").is_some() {
        quantities.push(cursor.scalar()?);
    }
    Ok(quantities)
}

fn expect_word(cursor: &mut Cursor<'_>, word: &str, form: &str) -> Read<Location> {
    if cursor.eat_word(word) {
        return Ok(cursor.last());
    }
    let help = format!("write `{form}`");
    Err(cursor.unexpected(&format!("expected `{word}`"), &help))
}
