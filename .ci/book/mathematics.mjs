// mdBook preprocessor: turns `$..$` and `$$..$$` into MathML while the book is built.
//
// Browsers draw MathML by themselves, so that a page needs no script, style sheet or font for its formulas. A formula that KaTeX does not
// understand ends the build. Code is left alone.

import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

if (process.argv[2] === "supports") {
    process.exit(process.argv[3] === "html" ? 0 : 1);
}

const katex = createRequire(process.env.KATEX_FOLDER + "/")("katex");

/** Characters that Markdown would read as its own. */
const MARKDOWN = /[*_[\]|`~\\]/g;

/** MathML of a formula, on one line, safe inside Markdown. */
function mathml(formula, displayMode) {
    const html = katex.renderToString(formula, { displayMode, output: "mathml", strict: "error", throwOnError: true });
    const bare = html.replace(/<annotation[^]*?<\/annotation>/g, "").replace(/\n/g, " ");
    return bare.replace(/>[^<]+</g, (text) => text.replace(MARKDOWN, (character) => `&#${character.codePointAt(0)};`));
}

/** A fenced block, a code span, a displayed formula, or a formula in a line: whichever begins first. */
const PIECES = /^( *)(```+|~~~+)[^]*?^ *\2 *$|(`+)[^]*?[^`]\3(?!`)|\$\$([^]+?)\$\$|\$([^\s$](?:[^$\n]*[^\s$])?)\$/gm;

function rendered(text) {
    return text.replace(PIECES, (piece, _indent, _fence, _ticks, display, inline) => {
        if (display !== undefined) return mathml(display, true);
        return inline === undefined ? piece : mathml(inline, false);
    });
}

function visit(items) {
    for (const { Chapter: chapter } of items) {
        if (!chapter) continue;
        try {
            chapter.content = rendered(chapter.content);
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
