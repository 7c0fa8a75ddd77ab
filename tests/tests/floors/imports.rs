//! The imports among the files of a crate, read from its source.
//!
//! Imports are `use` items, paths in code, and paths within macros. A name that a `mod.rs` exports
//! again counts as an import of the file that defines it. What does not count: the declarations of
//! a `mod.rs` (`mod x; pub use x::Y;`), `lib.rs`, test modules, and documentation.

use proc_macro2::{Span, TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use syn::visit::{self, Visit};
use syn::{Attribute, Ident, ItemMod, ItemUse, Macro, UseTree, Visibility};
use walkdir::WalkDir;

/// A module's path from the root of its crate.
type Module = Vec<String>;

/// One import of one file by another one.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Import {
    /// File that imports, relative to the folder of the source.
    pub from: String,
    /// Its line.
    pub line: usize,
    /// File that is imported.
    pub to: String,
}

/// Returns the imports among the source files of a crate. `source` is the folder of its root.
pub fn imports(source: &Path) -> BTreeSet<Import> {
    let mut files = BTreeMap::new();
    for path in rust_files(source) {
        let name = relative(source, &path);
        if name == "main.rs" {
            continue; // another crate
        }
        let text = fs::read_to_string(&path).unwrap();
        let tree = syn::parse_file(&text).unwrap_or_else(|error| panic!("{name}: {error}"));
        files.insert(module_of(&name), (name, tree));
    }
    let modules: BTreeSet<&Module> = files.keys().collect();
    let found: BTreeMap<&Module, Found> = files
        .iter()
        .map(|(module, (_, tree))| {
            let mut found = Found::of(module, &modules);
            found.visit_file(tree);
            (module, found)
        })
        .collect();
    let mut imports = BTreeSet::new();
    for (module, (from, _)) in &files {
        if from == "lib.rs" {
            continue;
        }
        for (line, path) in &found[module].paths {
            let (to, _) = &files[&definition(path, &found)];
            if from != to {
                imports.insert(Import {
                    from: from.clone(),
                    line: *line,
                    to: to.clone(),
                });
            }
        }
    }
    imports
}

/// Returns the module that defines the item of a path. Follows names that are exported again.
fn definition(path: &[String], found: &BTreeMap<&Module, Found>) -> Module {
    let mut path = path.to_vec();
    // Each round follows one export. The limit ends a cycle of exports.
    for _ in 0..10 {
        let length = (0..=path.len())
            .rev()
            .find(|length| found.contains_key(&path[..*length].to_vec()))
            .unwrap_or(0);
        let (module, rest) = path.split_at(length);
        let module = module.to_vec();
        let Some(name) = rest.first() else {
            return module;
        };
        let Some(target) = found[&module].exports.get(name) else {
            return module;
        };
        path = target.iter().chain(&rest[1..]).cloned().collect();
    }
    path
}

/// The imports and exports of one file, collected while its syntax tree is visited.
struct Found<'a> {
    /// The file's module, and the inline modules around the visited item.
    module: Module,
    /// Number of inline modules.
    inline: usize,
    modules: &'a BTreeSet<&'a Module>,
    /// Names that `use` gives to modules.
    names: BTreeMap<String, Module>,
    paths: Vec<(usize, Vec<String>)>,
    exports: BTreeMap<String, Vec<String>>,
}

impl<'a> Found<'a> {
    fn of(module: &Module, modules: &'a BTreeSet<&'a Module>) -> Self {
        Self {
            module: module.clone(),
            inline: 0,
            modules,
            names: BTreeMap::new(),
            paths: Vec::new(),
            exports: BTreeMap::new(),
        }
    }

    /// Returns a path from the root of the crate; `None` if it leads out of the crate or stays in
    /// this file.
    fn absolute(&self, segments: &[String]) -> Option<Vec<String>> {
        let (first, rest) = segments.split_first()?;
        let mut base = match &**first {
            "crate" => Vec::new(),
            "self" => self.module.clone(),
            "super" => self.above(&self.module)?,
            name if rest.is_empty() => return self.names.get(name).cloned(),
            name => match self.names.get(name) {
                Some(module) => module.clone(),
                None => {
                    let mut child = self.module.clone();
                    child.push(name.to_owned());
                    self.modules.contains(&child).then_some(child)?
                }
            },
        };
        let mut rest = rest;
        while let [first, others @ ..] = rest
            && first == "super"
        {
            base = self.above(&base)?;
            rest = others;
        }
        base.extend(rest.iter().cloned());
        Some(base)
    }

    fn above(&self, module: &[String]) -> Option<Module> {
        module.split_last().map(|(_, above)| above.to_vec())
    }

    fn add(&mut self, line: usize, segments: &[String]) {
        if let Some(path) = self.absolute(segments) {
            self.paths.push((line, path));
        }
    }

    /// Adds the paths of a `use`; those that only export a part of this module again are exports.
    fn add_use(&mut self, tree: &UseTree, before: &[String], is_public: bool) {
        let with = |ident: &Ident| [before, &[ident.to_string()]].concat();
        let (line, path, name) = match tree {
            UseTree::Path(path) => return self.add_use(&path.tree, &with(&path.ident), is_public),
            UseTree::Group(group) => {
                for tree in &group.items {
                    self.add_use(tree, before, is_public);
                }
                return;
            }
            UseTree::Name(name) if name.ident == "self" => (
                line_of(&name.ident),
                before.to_vec(),
                before.last().cloned(),
            ),
            UseTree::Name(name) => (
                line_of(&name.ident),
                with(&name.ident),
                Some(name.ident.to_string()),
            ),
            UseTree::Rename(rename) => (
                line_of(&rename.ident),
                with(&rename.ident),
                Some(rename.rename.to_string()),
            ),
            UseTree::Glob(glob) => (line_at(glob.star_token.spans[0]), before.to_vec(), None),
        };
        let Some(absolute) = self.absolute(&path) else {
            return;
        };
        let is_own = absolute.len() > self.module.len() && absolute.starts_with(&self.module);
        if let Some(name) = name {
            if is_public {
                self.exports.insert(name.clone(), absolute.clone());
            }
            if self.modules.contains(&absolute) {
                self.names.insert(name, absolute.clone());
            }
        }
        if !(is_public && is_own) {
            self.paths.push((line, absolute));
        }
    }

    /// Adds the paths in the tokens of a macro that begin with `crate` or `super`.
    fn add_tokens(&mut self, tokens: TokenStream) {
        let mut tokens = tokens.into_iter().peekable();
        while let Some(token) = tokens.next() {
            match token {
                TokenTree::Group(group) => self.add_tokens(group.stream()),
                TokenTree::Ident(ident) if ident == "crate" || ident == "super" => {
                    let mut segments = vec![ident.to_string()];
                    loop {
                        let is_colon = |token: &TokenTree| matches!(token, TokenTree::Punct(mark) if mark.as_char() == ':');
                        while tokens.next_if(is_colon).is_some() {}
                        match tokens.next_if(|token| matches!(token, TokenTree::Ident(_))) {
                            Some(ident) => segments.push(ident.to_string()),
                            None => break,
                        }
                    }
                    self.add(line_of(&ident), &segments);
                }
                _ => {}
            }
        }
    }
}

impl<'ast> Visit<'ast> for Found<'_> {
    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        let is_public = !matches!(item.vis, Visibility::Inherited);
        self.add_use(&item.tree, &[], is_public && self.inline == 0);
    }

    fn visit_item_mod(&mut self, item: &'ast ItemMod) {
        if item.content.is_none() || item.attrs.iter().any(is_test) {
            return;
        }
        self.module.push(item.ident.to_string());
        self.inline += 1;
        visit::visit_item_mod(self, item);
        self.inline -= 1;
        self.module.pop();
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let segments: Vec<String> = path
            .segments
            .iter()
            .map(|of| of.ident.to_string())
            .collect();
        if let Some(first) = path.segments.first()
            && segments.len() > 1
        {
            self.add(line_of(&first.ident), &segments);
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, item: &'ast Macro) {
        self.add_tokens(item.tokens.clone());
        visit::visit_macro(self, item);
    }

    fn visit_attribute(&mut self, _: &'ast Attribute) {}

    fn visit_visibility(&mut self, _: &'ast Visibility) {}
}

fn is_test(attribute: &Attribute) -> bool {
    attribute.path().is_ident("cfg")
        && attribute
            .parse_args::<Ident>()
            .is_ok_and(|argument| argument == "test")
}

fn line_of(ident: &Ident) -> usize {
    line_at(ident.span())
}

fn line_at(span: Span) -> usize {
    span.start().line
}

/// Returns the module of a file, by its name.
fn module_of(name: &str) -> Module {
    let path = name.strip_suffix(".rs").unwrap_or(name);
    let path = path.strip_suffix("mod").unwrap_or(path);
    path.split('/')
        .filter(|part| !part.is_empty() && *part != "lib")
        .map(str::to_owned)
        .collect()
}

fn relative(source: &Path, path: &Path) -> String {
    let path = path.strip_prefix(source).unwrap();
    let parts: Vec<_> = path.iter().map(|part| part.to_string_lossy()).collect();
    parts.join("/")
}

/// Returns every file of Rust in a folder and its subfolders, in order.
fn rust_files(folder: &Path) -> Vec<PathBuf> {
    WalkDir::new(folder)
        .sort_by_file_name()
        .into_iter()
        .map(|entry| entry.unwrap().into_path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "rs"))
        .collect()
}
