//! Closed loops: inputs of a model replaced by the laws of `--feedback`.

use dalembert_jit::FeedbackError;

use crate::entry::Entry;
use crate::error::CliError;
use crate::{model_file, names};

/// The flag.
const FLAG: &str = "--feedback";

/// The model with inputs replaced by laws.
///
/// # Errors
/// An unknown input, a law that is no expression, mistakes of the declaration that results.
pub(crate) fn close(
    entry: &Entry,
    feedback: &[String],
    skips_claims: bool,
) -> Result<Entry, CliError> {
    let laws: Vec<(String, &str)> = feedback
        .iter()
        .map(|text| law(text))
        .collect::<Result<_, _>>()?;
    let laws: Vec<(&str, &str)> = laws.iter().map(|(input, law)| (&**input, *law)).collect();
    let shown = format!("{} with {FLAG}", entry.name());
    let text = dalembert_jit::close(&shown, &entry.description().source, &laws).map_err(refusal)?;
    let mut closed = model_file::entries(&shown, &text, skips_claims)?;
    let closed = closed
        .pop()
        .ok_or(CliError::Usage("--feedback: the model is not in its text"))?;
    closed.check_size()?;
    Ok(closed)
}

/// `u=-4*x`, `thrust.2=-x` and `thrust[i in 1..=2]=-x[i]` as an input of the language and its law.
fn law(text: &str) -> Result<(String, &str), CliError> {
    let mut depth = 0_usize;
    let is_separator = |character: char| {
        match character {
            '[' => depth += 1,
            ']' => depth = depth.saturating_sub(1),
            _ => {}
        }
        character == '=' && depth == 0
    };
    let (input, law) = text
        .split_once(is_separator)
        .ok_or_else(|| CliError::value(FLAG, text, "INPUT=LAW, such as `u=-4*x-dot(x)`"))?;
    let input = match input.trim().split_once('.') {
        Some((family, member)) if member.parse::<usize>().is_ok() => format!("{family}[{member}]"),
        _ => input.trim().to_owned(),
    };
    Ok((input, law.trim()))
}

fn refusal(error: FeedbackError) -> CliError {
    match error {
        FeedbackError::Text(refused) => CliError::Declaration(refused),
        FeedbackError::Unknown { given, declared } if !declared.is_empty() => {
            let known = names::find(FLAG, "input", &given, declared.iter().map(String::as_str));
            known
                .err()
                .unwrap_or(CliError::Usage("--feedback: no such input"))
        }
        error => CliError::Input {
            place: FLAG.to_owned(),
            reason: error.to_string(),
        },
    }
}
