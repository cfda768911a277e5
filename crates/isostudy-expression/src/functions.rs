//! The names of all functions, for the parser and for messages.

/// All functions, by how many arguments they take.
const FUNCTIONS: [(&str, &[&str]); 6] = [
    (
        "one argument",
        &[
            "sqrt", "cbrt", "abs", "exp", "ln", "sin", "cos", "tan", "asin", "acos", "atan", "floor", "ceil",
            "round", "sign", "square",
        ],
    ),
    ("two arguments", &["atan2", "mod", "pow"]),
    ("three arguments", &["clamp", "mix"]),
    ("at least one argument", &["min", "max", "length"]),
    ("x, y, z, and a seed if wanted", &["noise"]),
    ("x, y, z, octaves, and a seed if wanted", &["fbm", "ridged", "billowed"]),
];

/// How many arguments a function takes.
pub(crate) fn arity(name: &str) -> Option<&'static str> {
    FUNCTIONS.iter().find(|(_, names)| names.contains(&name)).map(|(arity, _)| *arity)
}

/// For messages.
pub(crate) fn function_names() -> String {
    FUNCTIONS.iter().flat_map(|(_, names)| *names).copied().collect::<Vec<_>>().join(", ")
}
