//! One case for each slip into another notation, marked as in `refusals`.

use super::read;
use super::refusals::{refused, refused_expression, refused_in};

#[test]
fn slips_in_expressions_are_named() {
    refused_expression("«2x»", "missing `*` between `2` and `x`\nhelp: write `2*x`");
    refused_expression("«1.5e3m»", "missing `*` between `1.5e3` and `m`");
    refused_expression("«2f64»", "numbers have no type: `f64`\nhelp: write `2`");
    refused_expression("«0x10»", "numbers are decimal");
    refused_expression("«1e400»", "`1e400` is out of the range of doubles");
    refused_expression(
        "x «**» 2",
        "no `**` operator\nhelp: a power is written `x^2`",
    );
    refused_expression(
        "sin «x»",
        "function call needs parentheses\nhelp: write `sin(x)`",
    );
    refused_expression("«sin»^2*x", "the power of a function is written `sin(x)^2`");
    refused_expression("np«.»sin(x)", "unexpected `.`\nhelp: write `sin(..)`");
    refused_expression("m «v»^2", "missing operator before `v`");
    refused_expression("x «<» 1", "`<` is not differentiable");
    refused_expression("x «==» 1", "`==` is not differentiable");
    refused_expression("«if»(x)", "an expression has no cases, found `if`");
    refused_expression("x «if» y", "an expression has no cases");
    refused_expression("«|»x|", "the absolute value is written `abs(x)`");
    refused_expression(
        "theta«.»3",
        "unexpected `.`\nhelp: a member of a family is written `theta[3]`",
    );
    refused_expression("theta«.»dot^2", "help: write `dot(theta)`");
    refused_expression("theta«.»powi(2)", "help: write `a^b`");
    refused_expression("1«.»e5", "numbers are written `12`, `0.5`, `1.25e-7`");
    refused_expression("1«,»5", "help: a decimal number is written `1.5`");
    refused_expression("(x«,» x)", "expected `)`, found `,`");
    refused_expression(
        "«.5»*x",
        "a digit stands before the point\nhelp: write `0.5`",
    );
    refused_expression("«+»x", "there is no unary plus\nhelp: leave the sign out");
    refused_expression("x^«+»2", "there is no unary plus");
    refused_expression("dot«[x]»", "help: write `dot(x)`");
    refused_expression("«\"text\"»", "expected an expression, found a string");
    refused_expression("x «+»", "expected an expression");
    refused_expression("«(»)", "expected an expression");
    refused_expression(
        "sum(i in 1«..»N: x)",
        "expected `..=`, found `..`\nhelp: both ends belong to a range: write `1..=N`",
    );
}

#[test]
fn entries_begin_with_their_names() {
    refused_in(
        "impacts { «x» >= 0; }",
        "a surface begins with its name\nhelp: write `name: h >= 0 when g > 0 => LAW;`",
    );
    refused_in(
        "constraints { «d»(x) = 0; }",
        "a constraint begins with its name",
    );
    refused_in("constraints { «2»*d(x) = 0; }", "a constraint begins");
    refused_in("forces { «-»d(x); }", "a force begins with its name");
    refused_in("outputs { «x»; }", "an output begins with its name");
    refused_in("outputs { o «=» x; }", "expected `:`, found `=`");
    refused_in("impacts { wall «x» >= 0; }", "expected `:`, found `x`");
}

#[test]
fn surfaces_have_one_comparison_and_an_arrow_before_the_law() {
    let surface = |rest: &str| format!("impacts {{ w: {rest}; }}");
    refused_in(
        &surface("0 <= x «<=» 1"),
        "one comparison is expected, found two\nhelp: write two surfaces, `0 <= x` and `x <= 1`",
    );
    refused_in(
        &surface("x >= 0 when 0 < y «<» 1"),
        "help: write `when 0 < y when y < 1`",
    );
    refused_in(
        &surface("x >= 0 «&&» y >= 0"),
        "comparisons are not joined with `&&`\nhelp: write a surface for each",
    );
    refused_in(&surface("x «=» 0"), "expected `>=` or `<=`, found `=`");
    refused_in(&surface("x «=<» 0"), "expected `>=` or `<=`, found `=<`");
    refused_in(
        &surface("x >= 0 «->» elastic"),
        "expected `=>`, found `->`\nhelp: write `name: h >= 0 when g > 0 => LAW;`",
    );
    refused_in(&surface("x >= 0«,» elastic"), "expected `=>`, found `,`");
    refused_in(&surface("x >= 0«:» elastic"), "expected `=>`, found `:`");
    refused_in(
        &surface("x >= 0 «elastic»"),
        "expected `=>`, found `elastic`\nhelp: write `=> elastic`",
    );
    refused_in(
        &surface("x >= 0 => newton «0.5»"),
        "the coefficient of a law stands in parentheses\nhelp: write `newton(0.5)`",
    );
    refused_in(
        &surface("x >= 0 => «0.5»"),
        "expected an impact law, found `0.5`\nhelp: the laws are `elastic`",
    );
    refused_in(
        &surface("x >= 0 => «{ dot(x) = -dot(x); }»"),
        "expected an impact law, found `{..}`\nhelp: a map of the state is written `=> reset { dot(x) = -dot(x); }`",
    );
    refused_in(
        "view { region: x «>» 0; }",
        "expected `>=` or `<=`, found `>`\nhelp: write `region: h >= 0;`",
    );
}

#[test]
fn coordinates_and_parameters_keep_their_forms() {
    let coordinates = |entry: &str| format!("P {{ coordinates {{ {entry}; }} lagrangian = x; }}");
    refused(
        &coordinates("theta: angle«[3]»"),
        "the size of a family follows its name\nhelp: write `theta[3]: angle`",
    );
    refused(
        &coordinates("u: angle «in» (0, pi)"),
        "expected `;`, found `in`\nhelp: an angle takes all values on a circle",
    );
    refused(
        &coordinates("q[1«.».=3]"),
        "a range in brackets needs an index",
    );
    refused(
        &coordinates("x«,» y"),
        "expected `;`, found `,`\nhelp: every entry ends with `;`",
    );
    refused(
        &coordinates("u in (0«.».1)"),
        "an interval is written `(a, b)`",
    );
    refused_in(
        "parameters { «0» < m; }",
        "expected the name of a parameter, found `0`\nhelp: a parameter is written `m;`",
    );
    refused_in(
        "parameters { m = 1 «>» 0; }",
        "expected `;`, found `>`\nhelp: a parameter is written `m;`",
    );
    refused_in(
        "parameters { m[2] = «(1, 2)»; }",
        "a list of defaults stands in brackets\nhelp: write `[1, 2]`",
    );
    refused_in(
        "let f = «|»u| u^2;",
        "a function is written `let f(u) = ..;`",
    );
    refused_in("initial { x «==» 1; }", "expected `=`, found `==`");
    refused_in(
        "constraints { c: dot(x) «>=» 0; }",
        "a constraint is an equation; a wall is declared in `impacts`",
    );
    refused_in(
        "constraints { c[i «=» 1..=2]: d(x) = 0; }",
        "expected `in`, found `=`\nhelp: write `name[i in 1..=N]`",
    );
}

#[test]
fn zero_is_written_as_one_likes() {
    for zero in ["0", "0.0", "0.", "0e3"] {
        let spec = read(&format!(
            "P {{ coordinates {{ x; }} parameters {{ m > {zero}; }} lagrangian = x; }}"
        ));
        assert!(spec.is_ok(), "{zero}");
    }
}
