//! What compiles functions one after the other.

use std::collections::BTreeMap;

use cranelift_codegen::ir::{AbiParam, Type, types};
use cranelift_codegen::settings::{self, Configurable};
use cranelift_frontend::{FunctionBuilder, FunctionBuilderContext};
use cranelift_jit::{JITBuilder, JITModule};
use cranelift_module::{FuncId, Linkage, Module};

use super::function::Body;
use super::helpers::register;
use crate::machine::Code;

pub(super) struct Compiler {
    pub(super) module: JITModule,
    context: FunctionBuilderContext,
    helpers: BTreeMap<&'static str, FuncId>,
}

impl Compiler {
    pub(super) fn new() -> Option<Self> {
        let mut flags = settings::builder();
        for (name, value) in [
            ("opt_level", "speed"),
            ("enable_verifier", "false"),
            ("is_pic", "false"),
        ] {
            flags.set(name, value).ok()?;
        }
        let isa = cranelift_native::builder().ok()?;
        let isa = isa.finish(settings::Flags::new(flags)).ok()?;
        let mut builder = JITBuilder::with_isa(isa, cranelift_module::default_libcall_names());
        register(&mut builder);
        Some(Self {
            module: JITModule::new(builder),
            context: FunctionBuilderContext::new(),
            helpers: BTreeMap::new(),
        })
    }

    /// The machine code of a function, made the first time.
    pub(super) fn once(
        &mut self,
        code: &'static Code,
        velocity: Option<FuncId>,
        compiled: &mut BTreeMap<*const Code, FuncId>,
    ) -> Option<FuncId> {
        let key = core::ptr::from_ref(code);
        if let Some(id) = compiled.get(&key) {
            return Some(*id);
        }
        let id = self.define(code, velocity)?;
        compiled.insert(key, id);
        Some(id)
    }

    /// The type of pointers.
    pub(super) fn pointer(&self) -> Type {
        self.module.target_config().pointer_type()
    }

    fn define(&mut self, code: &Code, velocity: Option<FuncId>) -> Option<FuncId> {
        self.define_with(
            |compiler| {
                let pointer = compiler.pointer();
                let parameters = [pointer, types::F64, pointer, pointer, pointer];
                (parameters.to_vec(), vec![types::I32])
            },
            |compiler, builder| Body::begin(compiler, builder, code).write(velocity),
        )
    }

    /// Defines a function of these types of arguments and results.
    pub(super) fn define_with(
        &mut self,
        signature: impl FnOnce(&Self) -> (Vec<Type>, Vec<Type>),
        write: impl FnOnce(&mut Self, FunctionBuilder<'_>),
    ) -> Option<FuncId> {
        let (parameters, results) = signature(self);
        let mut context = self.module.make_context();
        let [parameters, results] =
            [parameters, results].map(|types| types.into_iter().map(AbiParam::new).collect());
        context.func.signature.params = parameters;
        context.func.signature.returns = results;
        let mut frontend = core::mem::take(&mut self.context);
        let builder = FunctionBuilder::new(&mut context.func, &mut frontend);
        write(self, builder);
        self.context = frontend;
        let signature = &context.func.signature;
        let id = self.module.declare_anonymous_function(signature).ok()?;
        self.module.define_function(id, &mut context).ok()?;
        self.module.clear_context(&mut context);
        Some(id)
    }

    /// A function of `helpers.rs`, of so many arguments.
    pub(super) fn helper(&mut self, name: &'static str, arguments: usize) -> Option<FuncId> {
        if let Some(id) = self.helpers.get(name) {
            return Some(*id);
        }
        let mut signature = self.module.make_signature();
        match name {
            "sin_cos" => {
                let pointer = self.pointer();
                signature.params = [types::F64, pointer].map(AbiParam::new).to_vec();
            }
            "jet_half" | "jet_middle" => {
                let pointer = AbiParam::new(self.pointer());
                signature.params = vec![pointer; arguments - 1];
                signature.params.push(AbiParam::new(types::I64));
                signature.returns = vec![AbiParam::new(types::F64)];
            }
            _ => {
                signature.params = vec![AbiParam::new(types::F64); arguments];
                signature.returns = vec![AbiParam::new(types::F64)];
            }
        }
        let id = self
            .module
            .declare_function(name, Linkage::Import, &signature)
            .ok()?;
        self.helpers.insert(name, id);
        Some(id)
    }
}
