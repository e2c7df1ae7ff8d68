//! Declarations as the tree of scopes a VCD header is.

use super::SignalDeclaration;
use std::collections::HashMap;

/// A scope: its own signals, then the scopes in it, both in the order they were declared.
#[derive(Debug, Default)]
pub(crate) struct Scope {
    pub name: String,
    /// Indices into the declarations.
    pub signals: Vec<usize>,
    pub children: Vec<Scope>,
    child_by_name: HashMap<String, usize>,
}

impl Scope {
    /// The tree over all declarations; its root has no name.
    pub(crate) fn of(declarations: &[SignalDeclaration]) -> Scope {
        let mut root = Scope::default();
        for (index, declaration) in declarations.iter().enumerate() {
            let mut scope = &mut root;
            for name in &declaration.path {
                scope = scope.child(name);
            }
            scope.signals.push(index);
        }
        root
    }

    fn child(&mut self, name: &str) -> &mut Scope {
        let index = match self.child_by_name.get(name) {
            Some(&index) => index,
            None => {
                self.children.push(Scope {
                    name: name.to_owned(),
                    ..Scope::default()
                });
                let index = self.children.len() - 1;
                self.child_by_name.insert(name.to_owned(), index);
                index
            }
        };
        &mut self.children[index]
    }
}
