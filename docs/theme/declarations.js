// Colours of declarations in the language of models.
(() => {
    if (!window.hljs) return;
    hljs.registerLanguage("dal", () => ({
        keywords: {
            keyword:
                "coordinates parameters lagrangian field constraints frame forces inputs cost impacts modes transitions initial view outputs " +
                "scenes claims let const until when otherwise for under in assume not reset",
            literal: "energy momentum multiplier exact locally_exact none conserved density symmetry angle",
            built_in: "d dot sum partial sin cos tan sqrt exp ln abs atan2",
        },
        contains: [hljs.COMMENT("//", "$"), { className: "number", begin: /\b\d[\d_]*(\.\d*)?([eE][+-]?\d+)?\b/ }],
    }));
    for (const block of document.querySelectorAll(".declaration code")) {
        block.className = "language-dal";
        hljs.highlightBlock(block);
    }
})();
