//! Models of a file: `model_file!("src/disk.dal")`, or `model_file!(#[global] "src/disk.dal")`.

use std::path::{Path, PathBuf};

use dalembert_codegen::models_of;
use proc_macro2::{TokenStream, TokenTree};
use quote::quote;

use dalembert_codegen::diagnostics::{Diagnostics, Location, global_of_modes};
use dalembert_codegen::spec::Declaration;

/// The whole pipeline, for the models of a file below a folder.
pub(crate) fn expand(input: TokenStream, folder: &Path) -> TokenStream {
    match read(input, folder).and_then(|file| file.expand()) {
        Ok(items) => items,
        Err(diagnostics) => diagnostics.into_compile_error(),
    }
}

/// A file that the macro was given.
struct File {
    /// The argument of the macro, for messages.
    at: Location,
    path: PathBuf,
    text: String,
    /// True if the macro asks for the global form of the model of the file.
    asks_for_global: bool,
}

fn read(input: TokenStream, folder: &Path) -> Result<File, Diagnostics> {
    let mut diagnostics = Diagnostics::new();
    let tokens: Vec<TokenTree> = input.into_iter().collect();
    let (asks_for_global, path) = match tokens.as_slice() {
        [
            TokenTree::Punct(hash),
            TokenTree::Group(attribute),
            path @ ..,
        ] if hash.as_char() == '#' && attribute.stream().to_string() == "global" => (true, path),
        path => (false, path),
    };
    let at = path
        .first()
        .map_or_else(|| proc_macro2::Span::call_site().into(), Location::of);
    let Ok(name) = syn::parse2::<syn::LitStr>(path.iter().cloned().collect()) else {
        diagnostics
            .error(at, "expected the path of a file, as a string in quotes")
            .help(
                "write `model_file!(\"src/disk.dal\")`; the path begins at the folder of the crate",
            );
        return Err(diagnostics);
    };
    let path = folder.join(name.value());
    match std::fs::read_to_string(&path) {
        Ok(text) => Ok(File {
            at,
            path,
            text,
            asks_for_global,
        }),
        Err(error) => {
            let text = format!("`{}` cannot be read: {error}", path.display());
            diagnostics
                .error(at, text)
                .help("the path begins at the folder of the crate");
            Err(diagnostics)
        }
    }
}

impl File {
    fn expand(&self) -> Result<TokenStream, Diagnostics> {
        let tokens: TokenStream = self.text.parse().map_err(|_| {
            let mut diagnostics = Diagnostics::new();
            let text =
                "not a text of the language: a bracket, a quote or a character is wrong there";
            self.refuse(&mut diagnostics, text);
            diagnostics
        })?;
        let models = models_of(tokens);
        let is_one = models.len() == 1;
        let mut diagnostics = Diagnostics::new();
        if models.is_empty() {
            self.refuse(&mut diagnostics, "no model here");
        }
        if self.asks_for_global && models.len() > 1 {
            diagnostics
                .error(self.at, "`#[global]` before a file with several models")
                .help("write it in the file, before each model whose global form is needed");
        }
        let mut items = TokenStream::new();
        for model in models {
            match self.expand_one(model, is_one) {
                Ok(written) => items.extend(written),
                Err(others) => others
                    .iter()
                    .for_each(|error| self.refuse(&mut diagnostics, error.message())),
            }
        }
        // Cargo builds the crate again when the file changes.
        let path = self.path.to_string_lossy();
        items.extend(quote!(
            const _: &[u8] = ::core::include_bytes!(#path);
        ));
        diagnostics.finish(items)
    }

    fn expand_one(&self, model: TokenStream, is_one: bool) -> Result<TokenStream, Diagnostics> {
        let mut declaration = dalembert_codegen::read(model)?;
        match &mut declaration {
            _ if !self.asks_for_global => {}
            Declaration::Model(spec) => spec.global = Some(self.at),
            Declaration::Modes(_) => return Err(global_of_modes(self.at)),
        }
        if is_one {
            // NOTE: inside of a macro, tokens of a text have no positions: the source cannot be read back from them.
            let source = self.text.trim().to_owned();
            match &mut declaration {
                Declaration::Model(spec) => spec.source = source,
                Declaration::Modes(modes) => modes
                    .modes
                    .iter_mut()
                    .for_each(|mode| mode.spec.source.clone_from(&source)),
            }
        }
        crate::expand_declaration(declaration)
    }

    /// Reports a mistake in the file. Its place is not known inside of a macro; the command line shows it.
    fn refuse(&self, diagnostics: &mut Diagnostics, message: &str) {
        let file = self.path.display();
        let text = format!("{message}\nnote: in {file}; `dalembert check {file}` shows the place");
        diagnostics.error(self.at, text);
    }
}
