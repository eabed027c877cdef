// mdBook preprocessor: sets `$..$` and `$$..$$` with KaTeX while the book is built, and marks declarations for `theme/declarations.js`.
//
// A page runs no script for its formulas. A page with formulas loads the style sheet and fonts of KaTeX, which `build` puts beside the
// pages: MathML alone would need a font for mathematics on the reader's machine. A formula that KaTeX does not understand ends the
// build. Code is left alone.

import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

if (process.argv[2] === "supports") {
    process.exit(process.argv[3] === "html" ? 0 : 1);
}

const katex = createRequire(process.env.KATEX_FOLDER + "/")("katex");

/** Characters that have a meaning in Markdown. */
const MARKDOWN = /[*_[\]|`~\\]/g;

/** A formula on one line, safe inside Markdown. Its source is left out: it would be read as text. */
function typeset(formula, displayMode) {
    const html = katex.renderToString(formula, { displayMode, strict: "error", throwOnError: true });
    const bare = html.replace(/<annotation[^]*?<\/annotation>/g, "").replace(/\n/g, " ");
    return bare.replace(/>[^<]+</g, (text) => text.replace(MARKDOWN, (character) => `&#${character.codePointAt(0)};`));
}

/** A fenced block, a code span, a displayed formula, or a formula in a line: whichever begins first. */
const PIECES = /^( *)(```+|~~~+)[^]*?^ *\2 *$|(`+)[^]*?[^`]\3(?!`)|\$\$([^]+?)\$\$|\$([^\s$](?:[^$\n]*[^\s$])?)\$/gm;

/** A block of code; a declaration stands in an element of its own, because highlight.js does not know the language. */
function marked(block) {
    const declaration = /^```dal\b.*$/m;
    if (!declaration.test(block)) return block;
    return `<div class="declaration">\n\n${block.replace(declaration, "```text")}\n\n</div>`;
}

/** The text of a page with its formulas set. */
function rendered(text, path) {
    let formulas = 0;
    const replaced = text.replace(PIECES, (piece, _indent, fence, _ticks, display, inline) => {
        if (fence) return marked(piece);
        const formula = display ?? inline;
        if (formula === undefined) return piece;
        formulas += 1;
        return typeset(formula, display !== undefined);
    });
    const root = "../".repeat(path.split("/").length - 1);
    return formulas === 0 ? replaced : `<link rel="stylesheet" href="${root}katex/katex.min.css">\n\n${replaced}`;
}

function visit(items) {
    for (const { Chapter: chapter } of items) {
        if (!chapter) continue;
        try {
            chapter.content = rendered(chapter.content, chapter.path);
        } catch (error) {
            console.error(`${chapter.path}: ${error.message}`);
            process.exit(1);
        }
        visit(chapter.sub_items);
    }
}

const [, book] = JSON.parse(readFileSync(0, "utf8"));
visit(book.items ?? book.sections);
process.stdout.write(JSON.stringify(book));
