//! Tests of error messages about names, numbers, definitions and families.

use super::{refused, refused_in, refused_term};

#[test]
fn unknown_names_come_with_a_suggestion() {
    refused_term(
        "«thta»",
        "unknown name `thta`\nhelp: did you mean the coordinate `theta`?",
    );
    refused_term(
        "«x·y»",
        "unknown name `x·y`\nhelp: the middle dot is part of the name; write `x*y`",
    );
    refused_term(
        "«xdot»",
        "unknown name `xdot`\nhelp: the velocity of `x` is written `dot(x)`",
    );
    refused_term("«dx»*x", "the differential of `x` is written `d(x)`");
    refused_term("«PI»*x", "unknown name `PI`\nhelp: write `pi`");
    refused_term("«inf»", "`inf` is not a number\nhelp: numbers are finite");
    refused_term("«time»", "help: time is written `t`");
    refused_in(
        "outputs { o: «E»; }",
        "unknown name `E`\nhelp: the energy is written `energy`",
    );
    refused_in(
        "outputs { o: «p_x»; }",
        "help: in `outputs`, the momentum of `x` is written `momentum(x)`",
    );
    refused_in(
        "outputs { J: x; dJ: «J» - 1; }",
        "unknown name `J`\nhelp: `J` is an output, and expressions cannot use outputs; declare its expression with `let` and use that",
    );
    refused_term(
        "«banana»",
        "unknown name `banana`\nhelp: a parameter is declared with `parameters { banana; }`",
    );
    refused_term("«ẋ»", "unknown name `ẋ`\nhelp: did you mean `dot(x)`?");
    refused_term(
        "«ν»*x",
        "`ν` (Greek nu) is not the declared `v`\nhelp: write `v`",
    );
    refused_term(
        "«θ»",
        "`θ` (Greek theta) is not the declared `theta`\nhelp: write `theta`",
    );
}

#[test]
fn unknown_functions_come_with_the_list() {
    refused_term(
        "«sinn»(x)",
        "unknown function `sinn`\nhelp: did you mean `sin`?",
    );
    refused_term("«log»(x)", "unknown function `log`\nhelp: write `ln(..)`");
    refused_term("«max»(x, y)", "`max` is not differentiable");
    refused_term(
        "«m»(x + y)",
        "`m` is a parameter, not a function\nhelp: a product is written `m*(x + y)`",
    );
    refused_term("«sin»(x, y)", "`sin` takes 1 argument, found 2");
    refused_term(
        "«atan»(y, x)",
        "`atan` takes 1 argument, found 2\nhelp: the angle of a point is written `atan2(y, x)`",
    );
    refused_term(
        "«ddot»(x)",
        "unknown function `ddot`\nhelp: a declaration has no accelerations",
    );
    refused_term("«norm»(x, y)", "help: write `sqrt(x^2 + y^2)`");
    refused_term("«pi»()", "`pi` is not a function\nhelp: write `pi`");
}

#[test]
fn numbers_without_a_value_are_refused() {
    refused_term("x/«0»", "division by zero");
    refused_term("«0^-1»", "division by zero");
    refused_term("«0^0»", "`0^0` is not defined");
    refused_term("«(-8)^(1/3)»", "is not a real number");
    refused_term("«ln(0)»", "`ln(0)` is not a real number");
    refused_term("«sqrt(-2)»", "`sqrt(-2)` is not a real number");
    refused_term(
        "x^«1000000000»",
        "the exponent `1000000000` is too large; the limit is 4096",
    );
    refused_term("2^«(2^40)»", "is too large; the limit is 4096");
    refused_term(
        "x^«(1/4096)»",
        "the denominator of the exponent `1/4096` is too large; the limit is 4095\nhelp: choose a smaller denominator; one third is `(1/3)`, not a decimal",
    );
    refused_term("«(10^30)^4000»", "an exact number of more than 4096 bits");
    refused_term(
        "x^«y»",
        "the exponent `y` is not a constant rational number\nhelp: write `exp(y*ln(x))`",
    );
}

#[test]
fn names_are_declared_once() {
    let twice = "P { coordinates { x; «x»; } lagrangian = dot(x)^2; }";
    refused(twice, "`x` declared again");
    let both = "P { coordinates { x; } parameters { «x» > 0; } lagrangian = dot(x)^2; }";
    refused(both, "`x` declared again");
    refused_in("let «m» = 2;", "`m` declared again");
    refused_in(
        "constraints { c: d(x) = 0; «c»: d(y) = 0; }",
        "constraint `c` declared again",
    );
    refused_in("outputs { o: x; «o»: y; }", "output `o` declared again");
}

#[test]
fn definitions_use_definitions_above_them() {
    refused_in(
        "let p = «q»; let q = p;",
        "defined in terms of itself: p -> q -> p",
    );
    refused_in("let p = «p» + 1;", "defined in terms of itself: p -> p");
    refused_in(
        "let f(u) = «f»(u - 1);",
        "defined in terms of itself: f -> f",
    );
    refused_in(
        "let p = «q»; let q = 1;",
        "`q` is used before it is defined\nhelp: move `let q` above `let p`",
    );
    refused_in("let f(u) = u + «thta»;", "unknown name `thta`");
    refused_in(
        "let X[i in 1..=3] = X[«i - 1»] + 1;",
        "`X[0]` is not defined above\nhelp: begin with `let X[0] = ..;`",
    );
    refused_in(
        "let f(u) = u; outputs { o: «f»; }",
        "`f` is a function\nhelp: write `f(u)`",
    );
    refused_in(
        "let f(u) = u; outputs { o: «f»(x, y); }",
        "`f` takes 1 argument, found 2",
    );
}

#[test]
fn families_have_members() {
    let chain = |rest: &str| {
        format!(
            "C {{ const N = 3; coordinates {{ q[N]; }} parameters {{ m[N] > 0 = 1; }}
                lagrangian = sum(i in 1..=N: m[i]*dot(q[i])^2); {rest} }}"
        )
    };
    refused(
        &chain("outputs { o: q[«4»]; }"),
        "`q[4]` does not exist\nhelp: `q` has the members 1 to 3",
    );
    refused(
        &chain("outputs { o: «q»; }"),
        "`q` is a family of 3\nhelp: write `q[1]`",
    );
    refused(&chain("outputs { o: «N»[1]; }"), "`N` is not a family");
    for slip in ["q1", "q_1"] {
        refused(
            &chain(&format!("outputs {{ o: «{slip}»; }}")),
            &format!("unknown name `{slip}`\nhelp: a member of `q` is written `q[1]`"),
        );
    }
    refused(
        &chain("outputs { o: «q»(2); }"),
        "`q` is a family, not a function\nhelp: write `q[2]`",
    );
    refused(
        &chain("initial { «q_dot»[1] = 1; }"),
        "unknown coordinate `q_dot`\nhelp: the velocity of `q[1]` is written `dot(q[1])`",
    );
    refused(
        &chain("outputs { o: q[«M»]; }"),
        "unknown name `M`\nhelp: a size is declared with `const M = 8;`",
    );
    refused(
        &chain("outputs { o: q[«m[1]»]; }"),
        "`m[1]` is not an integer known while building",
    );
    refused(&chain("initial { «q» = 1; }"), "`q` is a family of 3");
    refused(
        &chain("outputs { o: sum(i in «1..=10000»: x); }"),
        "takes more than 4096 values",
    );
    refused(
        "P { coordinates { q[«0»]; } lagrangian = dot(q[1])^2; }",
        "a family of 0",
    );
}

#[test]
fn families_of_entries_have_no_gaps() {
    refused_in(
        "impacts { w[1]: x >= 0; v: y >= 0; «w»[3]: x <= 2; }",
        "surface `w[2]` is not declared\nhelp: the members of `w` are counted from 1 without a gap",
    );
    refused_in(
        "constraints { «c»[i in 2..=3]: d(x) = i*y*d(y); }",
        "constraint `c[1]` is not declared",
    );
    refused_in(
        "outputs { o: x; «o»[1]: y; }",
        "output `o` declared alone and as a family\nhelp: choose another name",
    );
    refused_in(
        "forces { f[1]: d(x); «f»[1]: d(y); }",
        "force `f.1` declared again",
    );
    refused_in(
        "outputs { o[«0»]: y; }",
        "members are counted from 1, found 0",
    );
}

#[test]
fn constants_are_made_of_constants_above() {
    let with = |rest: &str| {
        format!("P {{ coordinates {{ x; }} parameters {{ m; }} lagrangian = dot(x)^2; {rest} }}")
    };
    refused(
        &with("const A = «B» + 1; const B = 3;"),
        "`B` is used before it is declared\nhelp: a `const` uses only a `const` above it",
    );
    refused(
        &with("const A = «m»;"),
        "`m` is a parameter, and a constant is expected here\nhelp: write numbers, `pi` and constants",
    );
    refused(
        &with("const G = «9.81»;"),
        "`9.81` is not an integer known while building\nhelp: a `const` is a size or an index",
    );
    let interval = |end: &str| {
        format!(
            "P {{ coordinates {{ x; u in (0, {end}); }} parameters {{ m; }} lagrangian = dot(x)^2 + dot(u)^2; }}"
        )
    };
    refused(
        &interval("«m»"),
        "`m` is a parameter, and a constant is expected",
    );
    refused(
        &interval("2*«x»"),
        "`x`: the end of an interval is a constant",
    );
    refused(
        &interval("«inf»"),
        "where an interval has no end, write a large one, for example `1e6`",
    );
}
