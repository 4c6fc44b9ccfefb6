//! Typed parameters: sliders in the window and `--set k=v` on the command line come from one list.

use std::fmt;

/// What values a parameter takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A whole number.
    Int {
        /// The least.
        min: u32,
        /// The greatest.
        max: u32,
        /// Unless set.
        default: u32,
    },
    /// A number.
    Float {
        /// The least.
        min: f64,
        /// The greatest.
        max: f64,
        /// Unless set.
        default: f64,
    },
    /// One of some names.
    Choice {
        /// The names; the first is the default.
        options: &'static [&'static str],
    },
}

/// One parameter of a structure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Param {
    /// The name used by `--set` and in files.
    pub id: &'static str,
    /// The name in the window.
    pub label: &'static str,
    /// One sentence that explains it.
    pub help: &'static str,
    /// What it is measured in; empty for pure numbers.
    pub unit: &'static str,
    /// Its values.
    pub kind: Kind,
}

/// The value of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
#[serde(untagged)]
pub enum Value {
    /// Of [`Kind::Int`].
    Int(u32),
    /// Of [`Kind::Float`].
    Float(f64),
    /// Of [`Kind::Choice`].
    Choice(&'static str),
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Int(v) => v.fmt(f),
            Self::Float(v) => v.fmt(f),
            Self::Choice(v) => v.fmt(f),
        }
    }
}

/// A value that a parameter does not take.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ParamError {
    /// No parameter has that name.
    #[error("there is no parameter '{id}' here; there is {known}")]
    Unknown {
        /// The name given.
        id: String,
        /// The names there are.
        known: String,
    },
    /// The value is outside the range or not of the kind.
    #[error("{id} = {value} won't do: {expected}")]
    Value {
        /// The parameter.
        id: &'static str,
        /// The value given.
        value: String,
        /// What it takes.
        expected: String,
    },
}

impl Param {
    /// The value unless set.
    pub const fn default(&self) -> Value {
        match self.kind {
            Kind::Int { default, .. } => Value::Int(default),
            Kind::Float { default, .. } => Value::Float(default),
            Kind::Choice { options } => Value::Choice(options[0]),
        }
    }

    /// What the parameter takes, in words.
    pub fn expected(&self) -> String {
        match self.kind {
            Kind::Int { min, max, .. } => format!("a whole number from {min} to {max}"),
            Kind::Float { min, max, .. } => format!("a number from {min} to {max}"),
            Kind::Choice { options } => options.join(" or "),
        }
    }

    /// Reads a value as written by a person.
    ///
    /// # Errors
    /// [`ParamError::Value`] if it is not one of the parameter's.
    pub fn parse(&self, text: &str) -> Result<Value, ParamError> {
        let value = match self.kind {
            Kind::Int { min, max, .. } => text.parse().ok().filter(|v| (min..=max).contains(v)).map(Value::Int),
            Kind::Float { min, max, .. } => text.parse().ok().filter(|v| (min..=max).contains(v)).map(Value::Float),
            Kind::Choice { options } => options.iter().find(|o| **o == text).map(|o| Value::Choice(o)),
        };
        value.ok_or_else(|| ParamError::Value { id: self.id, value: text.to_owned(), expected: self.expected() })
    }
}

/// A value for each parameter of a structure.
#[derive(Clone, Debug, PartialEq)]
pub struct ParamValues {
    params: &'static [Param],
    values: Vec<Value>,
}

impl ParamValues {
    /// The defaults.
    pub fn defaults(params: &'static [Param]) -> Self {
        Self { params, values: params.iter().map(Param::default).collect() }
    }

    /// Sets one from text.
    ///
    /// # Errors
    /// [`ParamError`] if there is no such parameter, or it does not take the value.
    pub fn set(&mut self, id: &str, text: &str) -> Result<(), ParamError> {
        let Some(i) = self.params.iter().position(|p| p.id == id) else {
            let known = if self.params.is_empty() {
                "none".to_owned()
            } else {
                self.params.iter().map(|p| p.id).collect::<Vec<_>>().join(", ")
            };
            return Err(ParamError::Unknown { id: id.to_owned(), known });
        };
        self.values[i] = self.params[i].parse(text)?;
        Ok(())
    }

    /// Every parameter with its value.
    pub fn iter(&self) -> impl Iterator<Item = (&'static Param, Value)> + '_ {
        self.params.iter().zip(self.values.iter().copied())
    }

    /// Those that differ from their defaults.
    pub fn changed(&self) -> impl Iterator<Item = (&'static Param, Value)> + '_ {
        self.iter().filter(|(param, value)| param.default() != *value)
    }

    /// Every parameter with its value, to be changed in place. Values of another kind are ignored
    /// when read, so a caller keeps to the kind of the parameter.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = (&'static Param, &mut Value)> + '_ {
        self.params.iter().zip(self.values.iter_mut())
    }

    /// The value of that id, if there is such a parameter.
    pub fn get(&self, id: &str) -> Option<Value> {
        self.params.iter().position(|p| p.id == id).map(|i| self.values[i])
    }

    /// A whole number; 0 if there is no such parameter, which a test of the registry rules out.
    pub fn int(&self, id: &str) -> u32 {
        match self.get(id) {
            Some(Value::Int(v)) => v,
            other => unexpected(id, other, 0),
        }
    }

    /// A number; 0 if there is no such parameter.
    pub fn float(&self, id: &str) -> f64 {
        match self.get(id) {
            Some(Value::Float(v)) => v,
            other => unexpected(id, other, 0.0),
        }
    }

    /// A choice; empty if there is no such parameter.
    pub fn choice(&self, id: &str) -> &'static str {
        match self.get(id) {
            Some(Value::Choice(v)) => v,
            other => unexpected(id, other, ""),
        }
    }
}

fn unexpected<V>(id: &str, found: Option<Value>, instead: V) -> V {
    debug_assert!(false, "parameter {id} read as another kind: {found:?}");
    instead
}

/// C_trav, the same for every structure that weighs costs.
pub const C_TRAV: Param = Param {
    id: "c_trav",
    label: "C_trav",
    help: "Cost of stepping into a node, in the same unit as C_isect: the surface area heuristic weighs the two.",
    unit: "",
    kind: Kind::Float { min: 0.01, max: 100.0, default: 1.0 },
};

/// C_plane, for structures with planes of any direction beside those perpendicular to the axes.
pub const C_PLANE: Param = Param {
    id: "c_plane",
    label: "C_plane",
    help: "Cost of stepping over a plane that is not perpendicular to an axis, in the same unit as C_trav.",
    unit: "",
    kind: Kind::Float { min: 0.01, max: 100.0, default: 2.0 },
};

/// C_isect, the same for every structure that weighs costs.
pub const C_ISECT: Param = Param {
    id: "c_isect",
    label: "C_isect",
    help: "Cost of testing one triangle, in the same unit as C_trav.",
    unit: "",
    kind: Kind::Float { min: 0.01, max: 100.0, default: 1.0 },
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_checked_and_explained() {
        const LIST: &[Param] = &[C_TRAV, Param { kind: Kind::Choice { options: &["near", "fixed"] }, id: "order", ..C_ISECT }];
        let mut values = ParamValues::defaults(LIST);
        values.set("c_trav", "2.5").expect("in range");
        values.set("order", "fixed").expect("an option");
        assert_eq!((values.float("c_trav"), values.choice("order")), (2.5, "fixed"));
        assert_eq!(
            values.set("c_trav", "nan").expect_err("no number").to_string(),
            "c_trav = nan won't do: a number from 0.01 to 100"
        );
        assert!(values.set("bins", "3").expect_err("unknown").to_string().contains("c_trav, order"));
    }
}
