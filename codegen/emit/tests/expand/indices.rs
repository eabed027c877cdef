//! Documentation of the emitted indices.

use dalembert_emit::try_expand;

#[test]
fn doc_comments_of_entries_stand_at_their_indices() {
    let source = "
        P {
            coordinates { /// First arm.
                x; y; }
            lagrangian = dot(x)^2 + dot(y)^2;
            impacts { /// Left.
                side[1]: x >= 0; floor: y >= 0; /// Right.
                ///
                /// It moves.
                side[2]: x <= 1 + t; }
            outputs { /// Both.
                o[i in 1..=2]: x; }
        }";
    let items = try_expand(source.parse().expect("tokens")).expect("a model");
    let text = items.to_string().replace([' ', '\n'], "");
    for part in [
        r#"#[doc="Firstarm."]pubconstx:usize=0usize;"#,
        r#"#[doc="`y`"]pubconsty:usize=1usize;"#,
        r#"#[doc="Left."]#[doc=""]#[doc="Right."]#[doc=""]#[doc="Itmoves."]pubconstside:[usize;2usize]=[0usize,2usize];"#,
        r#"#[doc="Both."]pubconsto:[usize;2usize]=[0usize,1usize];"#,
    ] {
        assert!(text.contains(part), "{part}");
    }
}
