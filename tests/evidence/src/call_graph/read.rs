//! Reading the call graph from an ELF file.

use super::function::{Callee, Code, Function};
use super::graph::CallGraph;
use super::instruction::Decoder;
use crate::files::{Result, problem};
use object::{Object, ObjectSection, ObjectSymbol, SectionKind, SymbolKind};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Marks of the linker: from here on there is code, or a table.
const CODE_MARK: &str = "$t";
const TABLE_MARK: &str = "$d";

/// The section with the addresses of the handlers of interrupts, which nothing calls.
const VECTORS: &str = ".vector_table";

impl CallGraph {
    /// Reads the part of an image that the functions whose names begin with `roots` can reach.
    ///
    /// # Errors
    /// The file cannot be read, no function has such a name, or an instruction is not understood.
    pub fn read(path: &Path, roots: &str) -> Result<Self> {
        let bytes = fs::read(path).map_err(|error| problem(path, error))?;
        let file = object::File::parse(&*bytes)
            .map_err(|error| problem(path, format!("not an image: {error}")))?;
        let image = Image::of(&file);
        image.graph(roots).map_err(|why| problem(path, why))
    }
}

/// What counts of an ELF file.
struct Image<'a> {
    /// Address and content of each section with code.
    code: Vec<(u32, &'a [u8])>,
    /// Content of each section with constants, and of each table in code. Instructions are none: by
    /// chance they may read as the address of a function.
    constants: Vec<&'a [u8]>,
    /// Names and sizes of functions by address.
    symbols: BTreeMap<u32, (String, u32)>,
    /// Begin and end of each table in code.
    tables: BTreeMap<u32, u32>,
}

impl<'a> Image<'a> {
    fn of(file: &object::File<'a>) -> Self {
        let sections = |wanted: fn(SectionKind) -> bool| {
            let sections = file
                .sections()
                .filter(move |section| wanted(section.kind()));
            sections.filter(|section| section.name() != Ok(VECTORS))
        };
        let code: Vec<_> = sections(|kind| kind == SectionKind::Text)
            .filter_map(|section| Some((section.address() as u32, section.data().ok()?)))
            .collect();
        let constants =
            sections(|kind| matches!(kind, SectionKind::ReadOnlyData | SectionKind::Data))
                .filter_map(|section| section.data().ok());
        let tables = tables(file);
        let in_code = code.iter().flat_map(|(begin, bytes)| {
            tables.iter().filter_map(|(from, to)| {
                let from = from.checked_sub(*begin)? as usize;
                bytes.get(from..to.checked_sub(*begin)? as usize)
            })
        });
        Self {
            constants: constants.chain(in_code).collect(),
            code,
            symbols: symbols(file),
            tables,
        }
    }

    fn graph(&self, roots: &str) -> Result<CallGraph> {
        let is_root = |name: &str| name.starts_with(roots);
        let named = self.symbols.iter().filter(|(_, (name, _))| is_root(name));
        let mut open: Vec<u32> = named.map(|(address, _)| *address).collect();
        if open.is_empty() {
            return Err(format!("no function {roots}…"));
        }
        let decoder = Decoder::new()?;
        let mut graph = CallGraph::default();
        while let Some(address) = open.pop() {
            if graph.functions.contains_key(&address) {
                continue;
            }
            let function = self.function(&decoder, address)?;
            for call in &function.calls {
                match call.callee {
                    Callee::At(target) => open.push(target),
                    Callee::Indirect => open.extend(self.stored(&graph)),
                }
            }
            graph.functions.insert(address, function);
            // Constants of a function that was read late may be addresses, too.
            graph.stored = self.stored(&graph);
            if graph.indirect_callers().next().is_some() {
                open.extend(&graph.stored);
            }
        }
        Ok(graph)
    }

    fn function(&self, decoder: &Decoder, address: u32) -> Result<Function> {
        let (name, size) = self
            .symbols
            .get(&address)
            .ok_or_else(|| format!("{address:#x}: a call of no function"))?;
        let bytes = self.code.iter().find_map(|(begin, bytes)| {
            let from = address.checked_sub(*begin)? as usize;
            bytes.get(from..from + *size as usize)
        });
        let bytes = bytes.filter(|bytes| !bytes.is_empty());
        let code = Code {
            address,
            bytes: bytes.ok_or_else(|| format!("{name}: no code"))?,
            table_ends: &self.tables,
        };
        let function = code.function(decoder, name);
        function.map_err(|problem| format!("{name}: {problem}"))
    }

    /// Returns the functions whose address is a stored word or a constant in the code read so far.
    fn stored(&self, graph: &CallGraph) -> BTreeSet<u32> {
        // The lowest bit of an address says that the code is Thumb.
        let function = |word: u32| {
            let address = word & !1;
            (word & 1 == 1 && self.symbols.contains_key(&address)).then_some(address)
        };
        let words = self
            .constants
            .iter()
            .flat_map(|bytes| bytes.chunks_exact(4));
        let words = words.map(|word| {
            word.iter()
                .rev()
                .fold(0, |word, byte| word << 8 | u32::from(*byte))
        });
        let in_code = graph
            .functions
            .values()
            .flat_map(|function| &function.constants);
        words.chain(in_code.copied()).filter_map(function).collect()
    }
}

/// Returns the functions by address. Of several names of one function, the first counts.
fn symbols(file: &object::File<'_>) -> BTreeMap<u32, (String, u32)> {
    let mut functions: BTreeMap<u32, (String, u32)> = BTreeMap::new();
    for symbol in file.symbols().filter(|of| of.kind() == SymbolKind::Text) {
        let Ok(name) = symbol.name() else { continue };
        if symbol.size() == 0 {
            continue;
        }
        // LLVM adds a suffix to names that it makes local.
        let name = name.split(".llvm.").next().unwrap_or(name);
        let name = format!("{:#}", rustc_demangle::demangle(name));
        let entry = (name, symbol.size() as u32);
        let known = functions
            .entry(symbol.address() as u32 & !1)
            .or_insert_with(|| entry.clone());
        if entry.0 < known.0 {
            *known = entry;
        }
    }
    functions
}

fn tables(file: &object::File<'_>) -> BTreeMap<u32, u32> {
    let marks = file.symbols().filter_map(|symbol| {
        let name = symbol.name().ok()?;
        let is_table = name.starts_with(TABLE_MARK);
        (is_table || name.starts_with(CODE_MARK)).then_some((symbol.address() as u32, is_table))
    });
    let marks: BTreeMap<u32, bool> = marks.collect();
    let after = marks.iter().skip(1);
    let pairs = marks.iter().zip(after);
    let tables = pairs.filter(|((_, is_table), _)| **is_table);
    tables
        .map(|((begin, _), (end, _))| (*begin, *end))
        .collect()
}
