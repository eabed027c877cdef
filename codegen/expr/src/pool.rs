//! Storage of expressions: symbols, nodes, and the properties that follow from the structure of each node.

use std::collections::HashMap;

use crate::field::{Modulus, PRIMES};
use crate::intern::{Table, WordHash, WordHasher};
use crate::node::{Assumption, ExprId, Node, SymbolId};
use crate::rational::Rational;
use crate::sign::Sign;

/// A set of expressions in which equal expressions have equal ids.
///
/// A pool may have a budget of steps (see [`Pool::with_budget`]). After the budget is spent, every constructor returns
/// the expression 1 and [`Pool::is_exhausted`] is true. Computations then end soon, and their results are meaningless.
#[derive(Clone, Debug)]
pub struct Pool {
    symbols: Vec<Symbol>,
    nodes: Vec<Node>,
    facts: Vec<Facts>,
    table: Table,
    sets: SymbolSets,
    /// `derivatives[symbol][expression]`: id + 1 of the derivative, or 0 if it has not been computed.
    pub(crate) derivatives: Vec<Vec<u32>>,
    /// Remaining steps.
    budget: u64,
    seed: u64,
    /// The primes of the seed.
    moduli: [Modulus; PRIMES],
}

#[derive(Clone, Debug)]
struct Symbol {
    name: String,
    latex: String,
    assumption: Assumption,
}

/// Properties of a node, computed at its creation.
#[derive(Copy, Clone, Debug)]
struct Facts {
    sign: Sign,
    finite: bool,
    /// Position in [`SymbolSets::sets`].
    symbols: u32,
    /// Nesting depth; 0 without operands.
    depth: u32,
}

impl Default for Pool {
    fn default() -> Self {
        Self::new()
    }
}

impl Pool {
    /// A pool that holds 0, 1 and pi.
    pub fn new() -> Self {
        Self::with_budget(u64::MAX)
    }

    /// A pool with a budget of steps. Making an expression costs one step, plus one for each operand and one for every
    /// full 64 bits of each of its numbers.
    pub fn with_budget(budget: u64) -> Self {
        let mut pool = Self {
            symbols: Vec::new(),
            nodes: Vec::new(),
            facts: Vec::new(),
            table: Table::default(),
            sets: SymbolSets::new(),
            derivatives: Vec::new(),
            budget: u64::MAX,
            seed: 0,
            moduli: Modulus::drawn(0),
        };
        pool.intern(Node::Number(Rational::ZERO));
        pool.intern(Node::Number(Rational::ONE));
        pool.intern(Node::Pi);
        pool.budget = budget;
        pool
    }

    /// Sets the seed of the random primes and points by which identities are tested.
    ///
    /// It should follow from the text whose expressions are tested. With a seed that is known beforehand, a text can hold numbers that are 0 at
    /// all its points.
    pub fn set_seed(&mut self, seed: u64) {
        self.seed = seed;
        self.moduli = Modulus::drawn(seed);
    }

    /// The seed of the random primes and points by which identities are tested.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// The random primes modulo which identities are tested, used in turn.
    pub(crate) fn moduli(&self) -> [Modulus; PRIMES] {
        self.moduli
    }

    /// True if the budget is spent. Expressions made after that are not the requested ones.
    pub fn is_exhausted(&self) -> bool {
        self.budget == 0
    }

    /// Removes the budget.
    pub fn lift_budget(&mut self) {
        self.budget = u64::MAX;
    }

    /// Nesting depth of an expression; 0 for an expression without operands.
    pub fn depth(&self, id: ExprId) -> usize {
        self.facts[id.index()].depth as usize
    }

    /// Bits of the longest number in the node of an expression, without its operands.
    pub fn number_bits(&self, id: ExprId) -> u64 {
        self.node(id).number_bits()
    }

    /// A new symbol. `name` and `latex` are its printed forms; they need not be unique.
    pub fn symbol(&mut self, name: &str, latex: &str, assumption: Assumption) -> SymbolId {
        let id = SymbolId::from_index(self.symbols.len());
        self.symbols.push(Symbol {
            name: name.into(),
            latex: latex.into(),
            assumption,
        });
        self.derivatives.push(Vec::new());
        id
    }

    /// The name a symbol was created with.
    pub fn symbol_name(&self, symbol: SymbolId) -> &str {
        &self.symbols[symbol.index()].name
    }

    /// The LaTeX form a symbol was created with.
    pub fn symbol_latex(&self, symbol: SymbolId) -> &str {
        &self.symbols[symbol.index()].latex
    }

    /// Assumption on a symbol.
    pub fn symbol_assumption(&self, symbol: SymbolId) -> Assumption {
        self.symbols[symbol.index()].assumption
    }

    /// The number of symbols.
    pub fn symbol_count(&self) -> usize {
        self.symbols.len()
    }

    /// The node of an expression.
    pub fn node(&self, id: ExprId) -> &Node {
        &self.nodes[id.index()]
    }

    /// The number of expressions.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Always false: a pool holds at least 0, 1 and pi.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The expression 0.
    pub fn zero(&self) -> ExprId {
        ExprId::from_index(0)
    }

    /// The expression 1.
    pub fn one(&self) -> ExprId {
        ExprId::from_index(1)
    }

    /// `id + shift`
    pub fn shifted(&mut self, id: ExprId, shift: u8) -> ExprId {
        let shift = self.number(Rational::from(i64::from(shift)));
        self.add(id, shift)
    }

    /// The circle constant.
    pub fn pi(&self) -> ExprId {
        ExprId::from_index(2)
    }

    /// The value of an expression that is a number.
    pub fn as_number(&self, id: ExprId) -> Option<&Rational> {
        match self.node(id) {
            Node::Number(value) => Some(value),
            _ => None,
        }
    }

    /// True if the expression is the number 0.
    pub fn is_syntactic_zero(&self, id: ExprId) -> bool {
        id == self.zero()
    }

    /// The sign of an expression where it is defined, as far as it follows from the structure of the expression.
    pub fn sign(&self, id: ExprId) -> Sign {
        self.facts[id.index()].sign
    }

    /// True if the structure shows that the expression is finite for all values of its symbols that satisfy their
    /// assumptions.
    pub fn is_finite(&self, id: ExprId) -> bool {
        self.facts[id.index()].finite
    }

    /// True if a symbol occurs in an expression.
    pub fn depends_on(&self, id: ExprId, symbol: SymbolId) -> bool {
        self.sets.contains(self.facts[id.index()].symbols, symbol)
    }

    /// True if any of the symbols occurs in an expression.
    pub fn depends_on_any(&self, id: ExprId, symbols: &[SymbolId]) -> bool {
        symbols.iter().any(|symbol| self.depends_on(id, *symbol))
    }

    /// The symbols that occur in an expression, in order of creation.
    pub fn symbols(&self, id: ExprId) -> Vec<SymbolId> {
        self.sets.members(self.facts[id.index()].symbols)
    }

    /// True if no symbol occurs in an expression.
    pub fn is_constant(&self, id: ExprId) -> bool {
        self.facts[id.index()].symbols == SymbolSets::EMPTY
    }

    /// The expressions that occur in `roots`, themselves included, in increasing order of id.
    pub fn reachable(&self, roots: &[ExprId]) -> Vec<ExprId> {
        self.reachable_where(roots, |_| true)
    }

    /// Same as [`Pool::reachable`], but visits only expressions that satisfy `keep`.
    pub(crate) fn reachable_where(
        &self,
        roots: &[ExprId],
        keep: impl Fn(ExprId) -> bool,
    ) -> Vec<ExprId> {
        let Some(top) = roots.iter().max() else {
            return Vec::new();
        };
        let mut marks = vec![0u64; top.index() / 64 + 1];
        let mark = |marks: &mut [u64], id: ExprId| {
            if keep(id) {
                marks[id.index() / 64] |= 1 << (id.index() % 64);
            }
        };
        roots.iter().for_each(|root| mark(&mut marks, *root));
        let mut found = Vec::new();
        // Operands have smaller ids, so one sweep downwards visits every expression before its operands.
        for block in (0..marks.len()).rev() {
            let mut below = u64::MAX;
            while marks[block] & below != 0 {
                let bit = 63 - (marks[block] & below).leading_zeros();
                below = (1 << bit) - 1;
                let id = ExprId::from_index(block * 64 + bit as usize);
                found.push(id);
                self.node(id)
                    .for_each_operand(|operand| mark(&mut marks, operand));
            }
        }
        found.reverse();
        found
    }

    /// The id of a node; assigns an id if the node is new. The node must be in the normal form of the constructors.
    pub(crate) fn intern(&mut self, node: Node) -> ExprId {
        self.budget = self.budget.saturating_sub(node.steps());
        if self.is_exhausted() {
            return self.one();
        }
        let hash = WordHasher::hash_of(&node);
        if let Some(position) = self
            .table
            .find(hash, |position| self.nodes[position] == node)
        {
            return ExprId::from_index(position);
        }
        let facts = Facts {
            sign: self.derive_sign(&node),
            finite: self.derive_finiteness(&node),
            symbols: self.symbol_set(&node),
            depth: self.derive_depth(&node),
        };
        let id = ExprId::from_index(self.nodes.len());
        self.table.push(hash);
        self.nodes.push(node);
        self.facts.push(facts);
        id
    }

    fn derive_depth(&self, node: &Node) -> u32 {
        let mut depth = 0;
        node.for_each_operand(|operand| depth = depth.max(self.facts[operand.index()].depth + 1));
        depth
    }

    fn symbol_set(&mut self, node: &Node) -> u32 {
        if let Node::Symbol(symbol) = node {
            return self.sets.singleton(*symbol);
        }
        let mut set = SymbolSets::EMPTY;
        node.for_each_operand(|operand| {
            set = self.sets.union(set, self.facts[operand.index()].symbols);
        });
        set
    }
}

/// Sets of symbols. Each distinct set is stored once, and unions are cached, since few distinct sets occur.
#[derive(Clone, Debug)]
struct SymbolSets {
    /// Bit sets without trailing zero words.
    sets: Vec<Box<[u64]>>,
    positions: HashMap<Box<[u64]>, u32, WordHash>,
    unions: HashMap<(u32, u32), u32, WordHash>,
}

impl SymbolSets {
    const EMPTY: u32 = 0;

    fn new() -> Self {
        let mut sets = Self {
            sets: Vec::new(),
            positions: HashMap::default(),
            unions: HashMap::default(),
        };
        sets.position(Box::default());
        sets
    }

    fn position(&mut self, set: Box<[u64]>) -> u32 {
        if let Some(position) = self.positions.get(&set) {
            return *position;
        }
        let position = self.sets.len() as u32;
        self.sets.push(set.clone());
        self.positions.insert(set, position);
        position
    }

    fn singleton(&mut self, symbol: SymbolId) -> u32 {
        let mut set = vec![0; symbol.index() / 64 + 1];
        set[symbol.index() / 64] = 1 << (symbol.index() % 64);
        self.position(set.into())
    }

    fn union(&mut self, a: u32, b: u32) -> u32 {
        if a == b || b == Self::EMPTY {
            return a;
        }
        if a == Self::EMPTY {
            return b;
        }
        let pair = (a.min(b), a.max(b));
        if let Some(union) = self.unions.get(&pair) {
            return *union;
        }
        let (short, long) = (&self.sets[a as usize], &self.sets[b as usize]);
        let (short, long) = if short.len() > long.len() {
            (long, short)
        } else {
            (short, long)
        };
        let mut words = long.clone();
        words
            .iter_mut()
            .zip(short)
            .for_each(|(word, other)| *word |= other);
        let union = self.position(words);
        self.unions.insert(pair, union);
        union
    }

    fn contains(&self, set: u32, symbol: SymbolId) -> bool {
        let word = self.sets[set as usize].get(symbol.index() / 64);
        word.is_some_and(|word| word >> (symbol.index() % 64) & 1 == 1)
    }

    fn members(&self, set: u32) -> Vec<SymbolId> {
        let words = &self.sets[set as usize];
        (0..words.len() * 64)
            .map(SymbolId::from_index)
            .filter(|s| self.contains(set, *s))
            .collect()
    }
}
