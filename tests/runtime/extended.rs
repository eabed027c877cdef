//! Extended numbers: reference values of 70 digits, identities, infinities and NaN, comparison and decimal text.

use dalembert::extended::{Extended, NotDecimal};
use dalembert::numbers::Numbers;

/// Values of functions at doubles, computed by `mpmath` 1.3 with 110 digits from the exact values of these doubles.
#[rustfmt::skip]
const VALUES: &[(&str, &[f64], &str)] = &[
    ("sin", &[1e-30], "1.000000000000000083336420607585985350931336026868654502364509616882196e-30"),
    ("sin", &[0.7], "6.442176872376910197067980902825121612742878370285401540431111498660245e-1"),
    ("sin", &[-3.1], "-4.158066243329049045367038793982274244261014474816846945610694962048575e-2"),
    ("sin", &[22.0], "-8.851309290403875921690256815772332463289203951332566442330835298089552e-3"),
    ("sin", &[1000000000000000.0], "8.582727931702358355238863908484066466002034082207297078153417717877363e-1"),
    ("cos", &[1e-30], "9.999999999999999999999999999999999999999999999999999999999995e-1"),
    ("cos", &[0.7], "7.648421872844884548648723598739629158509581390674649115142181400536783e-1"),
    ("cos", &[-3.1], "-9.991351502732794681854807595499013763088026204351601521625840127475656e-1"),
    ("cos", &[11.0], "4.425697988050785748355024723941573225727359000102314086094543238189845e-3"),
    ("cos", &[1000000000000000.0], "-5.131937377869702522345361364231649295881567712447514983212403617951123e-1"),
    ("tan", &[1e-30], "1.000000000000000083336420607585985350931336026868654502364510116882196e-30"),
    ("tan", &[0.7], "8.422883804630793722133176426063604267307690979536796234095485913385416e-1"),
    ("tan", &[-core::f64::consts::FRAC_PI_2], "-1.633123935319536975596773704152891653086406810491030289758454804937121e+16"),
    ("tan", &[1000000000000000.0], "-1.672414782127583042955521426960790550330409105540911892437370029501725"),
    ("asin", &[1e-30], "1.000000000000000083336420607585985350931336026868654502364509950215529e-30"),
    ("asin", &[0.7], "7.753974966107530015554257442371730995077594174483078430624466654478492e-1"),
    ("asin", &[-0.999999999999], "-1.570794912596976750838108920016925184900195963720750422632649380272093"),
    ("acos", &[1e-30], "1.570796326794896619231321691638751442098584699604216489879886310802977"),
    ("acos", &[0.7], "7.95398830184143617675895947402578342590825282239245067425025630706059e-1"),
    ("acos", &[0.999999999999], "1.414197919868393212771622826257198388735966802487854822915881815629619e-6"),
    ("atan", &[1e-30], "1.000000000000000083336420607585985350931336026868654502364509450215529e-30"),
    ("atan", &[0.7], "6.107259643892085867391139201101941183421589577627363117206768632835294e-1"),
    ("atan", &[-3e+20], "-1.570796326794896619227988358306418108765251366354219577154138975166254"),
    ("exp", &[1e-30], "1.000000000000000000000000000001000000000000000083336420607586485350931"),
    ("exp", &[0.7], "2.0137527074704764321959645191842468385320905140470437123137094153874"),
    ("exp", &[-300.3], "3.813880528480448866876664266875978683871604488601118154895703808087309e-131"),
    ("exp", &[709.7], "1.654984027680264403080250283472354982280958635865216658727333200773017e+308"),
    ("ln", &[1e-310], "-7.138013788281541651006446006623883741382338559765869930151338887094278e+2"),
    ("ln", &[0.7], "-3.566749439387324423539544041072745145718090708994979507823966124342229e-1"),
    ("ln", &[1.000000001], "1.000000082240370916683332509831604718087076622181121685920972231223776e-9"),
    ("ln", &[3e+250], "5.767448855371795306169899419912282771496220307353501291366018869415384e+2"),
    ("log1p", &[1e-310], "9.999999999999969449327502897691969360577315247038115033484093633830613e-311"),
    ("log1p", &[1e-30], "1.000000000000000083336420607585485350931336026785318081756924128058785e-30"),
    ("log1p", &[0.2], "1.823215567939546354635765636974857605958766967327486730644225514677688e-1"),
    ("log1p", &[0.7], "5.306282510621703701086484661262551532870721272647381823933199747238751e-1"),
    ("log1p", &[-0.3], "-3.566749439387323630523097880246625976871525626301861929735355882534731e-1"),
    ("log1p", &[-0.999999999999], "-2.763104323789335857145570331626762843702165433570273052216639670842402e+1"),
    ("log1p", &[3e+250], "5.767448855371795306169899419912282771496220307353501291366018869415384e+2"),
    ("sinh", &[1e-30], "1.000000000000000083336420607585985350931336026868654502364509950215529e-30"),
    ("sinh", &[0.2], "2.01336002541093998950584230440125206418113680812091141818708240333115e-1"),
    ("sinh", &[-0.3], "-3.045202934471426073528463978719910236327026973871408019331268160465123e-1"),
    ("sinh", &[710.4], "1.666364283280649584221380394547531739009058746471143919385450461644351e+308"),
    ("cosh", &[1e-30], "1.0000000000000000000000000000000000000000000000000000000000005"),
    ("cosh", &[0.7], "1.255169005630942984476791065484905888583163338348679416840134247378641"),
    ("cosh", &[-700.1], "5.604498855366304563537813332070135487062039735444721436405373799416889e+303"),
    ("tanh", &[1e-30], "1.000000000000000083336420607585985350931336026868654502364509450215529e-30"),
    ("tanh", &[0.2], "1.973753202249040114078777922452633402797309868612557932339276773218705e-1"),
    ("tanh", &[-0.3], "-2.913126124515908956581600157693989482617220391278626469821929337105998e-1"),
    ("tanh", &[40.7], "9.99999999999999999999999999999999991098582547830565565191408512658512e-1"),
    ("asinh", &[1e-30], "1.000000000000000083336420607585985350931336026868654502364509616882196e-30"),
    ("asinh", &[0.2], "1.986901103492414173612693524957378743794250544223527897252239389415718e-1"),
    ("asinh", &[-0.3], "-2.956730475634224284687025752964713192803524314876418184090139247115441e-1"),
    ("asinh", &[2.5], "1.647231146371095710624858610443619663504414430193236528220310093084398"),
    ("asinh", &[1e+200], "4.612101657793690820827486452708413792897283556341530323478010487840682e+2"),
    ("sqrt", &[2.0], "1.414213562373095048801688724209698078569671875376948073176679737990732"),
    ("sqrt", &[1e-200], "9.999999999999999910501311995413797579771301219335625545734285277601106e-101"),
    ("sqrt", &[3e+250], "1.732050807568877225195299352525922941995286083838415187761263081937718e+125"),
    ("atan2", &[1.0, -3.0], "2.81984209919315104506123876892084156517641410381744962954214153295106"),
    ("atan2", &[-1e-30, 2.0], "-5.000000000000000416682103037929926754656680134343272511822548501077646e-31"),
    ("atan2", &[3e+200, -7.0], "1.570796326794896619231321691639751442098584699687552910487472296153908"),
    ("atan2", &[-2.0, -1e-25], "-1.570796326794896619231321741639751442098586624431040370079426364753376"),
    ("atan2", &[5e-300, 3e-300], "1.030376826524312424780467757816587513040394925027358176548504184922086"),
    ("powf", &[2.3, 0.3333333333333333], "1.320006121795912343364991228789529110278014187740236027823895269530459"),
    ("powf", &[1e-100, 0.7], "1.000000000000010239526275464461417742368066930114859461729685984531677e-70"),
    ("powf", &[7e+80, -2.6], "6.349581412486134084062723317757978125971296610202611767601513398388266e-211"),
    ("powf", &[-1.5, 3.0], "-3.375"),
    ("powf", &[-1.5, -4.0], "1.975308641975308641975308641975308641975308641975308641975308641975309e-1"),
    ("powf", &[-1.0, 1125899906842625.0], "-1"),
    ("powf", &[-1.0, 9007199254740992.0], "1"),
    ("product", &[1e+308, 1e-308], "9.999999999999999203056889666889164173666619123620331031389307785417486e-1"),
    ("quotient", &[1e-200, 3e-05], "3.333333333333333189220238784460468055700622217917157984596331326641489e-196"),
    ("quotient", &[1e+300, -7.0], "-1.428571428571428646435371793149171783863526544440227364165505879302575e+299"),
];

fn evaluated<const P: usize>(function: &str, at: &[f64]) -> Extended<P> {
    let x = Extended::<P>::from(at[0]);
    let other = || Extended::<P>::from(at[1]);
    macro_rules! of_one_number {
        ($($name:ident)+) => {
            match function {
                $(stringify!($name) => return Numbers::$name(x),)+
                _ => {}
            }
        };
    }
    dalembert_numbers::functions_of_one_number!(of_one_number);
    match function {
        "sqrt" => Numbers::sqrt(x),
        "atan2" => Numbers::atan2(x, other()),
        "powf" => Numbers::powf(x, at[1]),
        "product" => x * other(),
        "quotient" => x / other(),
        _ => panic!("no function {function}"),
    }
}

/// The relative error of a number.
fn error<const P: usize>(found: Extended<P>, expected: &str) -> f64 {
    let exact: Extended<4> = expected.parse().expect("a decimal number");
    let found = found
        .parts()
        .into_iter()
        .fold(Extended::<4>::ZERO, |sum, part| sum + Extended::from(part));
    ((found - exact) / exact).nearest().abs()
}

fn check_values<const P: usize>(units: f64) {
    for (function, at, expected) in VALUES {
        let found = evaluated::<P>(function, at);
        let error = error(found, expected);
        // Digits below the smallest double are lost.
        let lost = 5e-324 / found.nearest().abs();
        let bound = units * Extended::<P>::ROUNDING + lost;
        assert!(
            error <= bound,
            "{function} at {at:?} in {P} parts: {found}, error {error:e} of {bound:e}"
        );
    }
}

#[test]
fn functions_have_all_digits_of_their_numbers() {
    check_values::<1>(1.0);
    check_values::<2>(2.0);
    check_values::<3>(2.0);
    check_values::<4>(4.0);
}

#[test]
fn every_function_of_one_number_has_values() {
    macro_rules! assert_tried {
        ($($name:ident)+) => {$(
            let has_value = VALUES.iter().any(|(function, ..)| *function == stringify!($name));
            assert!(has_value, "write values of {} above", stringify!($name));
        )+};
    }
    dalembert_numbers::functions_of_one_number!(assert_tried);
}

/// Random numbers with random digits in all parts, of many magnitudes.
fn samples<const P: usize>() -> impl Iterator<Item = Extended<P>> {
    let mut seed = 0x9e37_79b9_7f4a_7c15_u64;
    let mut next = move || {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    core::iter::repeat_with(move || {
        let size = Numbers::exp(Extended::<P>::from(40.0 * next()));
        let unit = Extended::<P>::ROUNDING;
        let mut number = Extended::from(next());
        let mut factor = 1.0;
        while factor > unit {
            factor *= 2e-16;
            number = number + Extended::from(factor * next());
        }
        number * size
    })
}

/// True if no part overlaps the next.
fn is_normal<const P: usize>(number: Extended<P>) -> bool {
    number
        .parts()
        .windows(2)
        .all(|pair| pair[0] + pair[1] == pair[0])
}

fn check_identities<const P: usize>() {
    let unit = Extended::<P>::ROUNDING;
    let near = |name: &str, a: Extended<P>, b: Extended<P>, size: f64| {
        let apart = (a - b).nearest().abs();
        assert!(apart <= 16.0 * unit * size, "{name} in {P} parts: {a} {b}");
        assert!(is_normal(a) && is_normal(b), "{name}: {a:?} {b:?}");
    };
    let one = Extended::<P>::from(1.0);
    let mut numbers = samples::<P>();
    for round in 0..1000 {
        let mut next = || numbers.next().expect("a number");
        let (x, y, z) = (next(), next(), next());
        let size = |number: Extended<P>| number.nearest().abs();
        near("sums", (x + y) - x, y, size(x).max(size(y)));
        near("quotients", (x / y) * y, x, size(x));
        near(
            "distribution",
            (x + y) * z,
            x * z + y * z,
            size(x * z) + size(y * z),
        );
        near("fused", x.mul_add(y, z), x * y + z, size(x * y) + size(z));
        near("roots", Numbers::sqrt(x * x), Numbers::abs(x), size(x));
        // A number and its negative cancel to 0.
        assert_eq!((x + -x).parts(), [0.0; P]);
        if round % 20 > 0 {
            continue;
        }
        let (sine, cosine) = Numbers::sin_cos(x / (one + Numbers::abs(x)));
        near("circle", sine * sine + cosine * cosine, one, 1.0);
        near(
            "powers",
            Numbers::exp(Numbers::ln(x * x)),
            x * x,
            200.0 * size(x * x),
        );
        near(
            "angles",
            Numbers::tan(Numbers::atan2(x, y)),
            x / y,
            size(x / y) * (1.0 + size(x / y) + size(y / x)),
        );
    }
}

#[test]
fn arithmetic_obeys_its_laws_to_rounding() {
    check_identities::<1>();
    check_identities::<2>();
    check_identities::<3>();
    check_identities::<4>();
}

#[test]
fn a_difference_has_the_digits_behind_those_that_cancel() {
    let tiny = Extended::<3>::from(1e-40) / Extended::from(3.0);
    let back = (Extended::from(1.0) + tiny) - Extended::from(1.0);
    assert!(((back - tiny) / tiny).nearest().abs() < 1e-7);
}

#[test]
fn what_is_infinite_or_no_number_is_so_in_parts() {
    type X = Extended<3>;
    let (zero, one) = (X::from(0.0), X::from(1.0));
    let (infinite, nan) = (X::from(f64::INFINITY), X::from(f64::NAN));
    for number in [
        one / zero,
        infinite + one,
        infinite * infinite,
        Numbers::exp(X::from(1000.0)),
        Numbers::cosh(X::from(-800.0)),
        Numbers::sqrt(infinite),
        X::from(1e300) * X::from(1e300),
        X::from(f64::MAX) + X::from(f64::MAX),
        Numbers::powf(zero, -0.3),
        -Numbers::ln(zero),
        -Numbers::log1p(-one),
    ] {
        assert_eq!(number.nearest(), f64::INFINITY, "{number:?}");
    }
    for number in [
        zero / zero,
        infinite - infinite,
        infinite * zero,
        nan + one,
        nan * zero,
        Numbers::sqrt(-one),
        Numbers::ln(-one),
        Numbers::log1p(X::from(-1.5)),
        Numbers::log1p(nan),
        Numbers::asin(X::from(1.0) + X::from(1e-40)),
        Numbers::sin(infinite),
        Numbers::sin(X::from(1e17)),
        Numbers::exp(nan),
        Numbers::tanh(nan),
        Numbers::sinh(nan),
        Numbers::atan2(nan, one),
        Numbers::powf(-one, 0.3),
        Numbers::powf(-one, 1125899906842624.5),
        Numbers::max(nan, nan),
    ] {
        assert!(number.nearest().is_nan(), "{number:?}");
    }
    assert_eq!((one / infinite).parts(), [0.0; 3]);
    assert_eq!(Numbers::exp(X::from(-1000.0)).parts(), [0.0; 3]);
    assert_eq!(Numbers::tanh(infinite), one);
    assert_eq!(Numbers::max(nan, one), one);
    assert_eq!(Numbers::max(one, nan), one);
    let sign = |number: X| number.nearest().is_sign_negative();
    assert!(sign(Numbers::atan(-zero)) && sign(Numbers::sqrt(-zero)) && sign(-zero * one));
}

#[test]
fn angles_on_the_axes_have_all_digits() {
    type X = Extended<4>;
    let pi = X::constant(dalembert::numbers::PI);
    let (zero, one, infinite) = (X::from(0.0), X::from(1.0), X::from(f64::INFINITY));
    let eighth = pi / X::from(4.0);
    for (y, x, eighths) in [
        (zero, -one, 4.0),
        (-zero, -one, 4.0),
        (one, zero, 2.0),
        (-one, zero, -2.0),
        (infinite, one, 2.0),
        (one, -infinite, 4.0),
        (-infinite, -infinite, -3.0),
        (infinite, infinite, 1.0),
        (zero, one, 0.0),
    ] {
        let angle = Numbers::atan2(y, x);
        let apart = (angle - eighth * X::from(eighths)).nearest().abs();
        assert!(apart <= 8.0 * X::ROUNDING, "{y} {x}: {angle}");
    }
    // The sine of the rounded value of pi is its rounding error.
    assert!(Numbers::sin(pi).nearest().abs() < 4.0 * X::ROUNDING);
    assert_eq!(Numbers::cos(pi), -one);
}

#[test]
fn numbers_compare_by_all_their_digits() {
    type X = Extended<2>;
    let (one, more) = (X::from(1.0), X::of_parts([1.0, 1e-25]));
    assert!(one < more && one != more);
    assert!(-more < -one && X::from(f64::NAN).partial_cmp(&one).is_none());
    assert_eq!(Numbers::max(one, more), more);
    assert_eq!(Numbers::abs(-more), more);
    assert_eq!(Numbers::turned(one, -more), -one);
}

#[test]
fn decimal_text_is_read_and_written_to_the_last_digit() {
    let text = "-6.4421768723769105367261435139872018306581384457368964474396e-1";
    let number: Extended<4> = text.parse().expect("a number");
    assert_eq!(format!("{number:.58}"), text);
    let tenth: Extended<3> = "0.1".parse().expect("a number");
    assert!(
        (tenth * Extended::from(10.0) - Extended::from(1.0))
            .nearest()
            .abs()
            < 1e-47
    );
    assert_eq!(
        format!(
            "{:.3} {:.0} {:.2}",
            tenth,
            Extended::<2>::from(9.7),
            Extended::<2>::from(-99.999)
        ),
        "1.000e-1 1e1 -1.00e2"
    );
    assert_eq!(
        format!("{}", Extended::<2>::from(0.5)),
        "5.000000000000000000000000000000e-1"
    );
    for (text, value) in [
        ("12", 12.0),
        ("1e300", 1e300),
        (".5", 0.5),
        ("2.", 2.0),
        ("-0.25E+1", -2.5),
        ("4.9e-310", 4.9e-310),
    ] {
        assert_eq!(
            text.parse::<Extended<2>>().map(|parsed| parsed.nearest()),
            Ok(value),
            "{text}"
        );
    }
    for text in ["", "-", ".", "1e", "1x", "0.1.2", "1e500", "nan", "--1"] {
        assert_eq!(text.parse::<Extended<2>>(), Err(NotDecimal), "{text}");
    }
}
