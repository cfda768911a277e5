//! Settings that grow: a type that another crate may not write out field by field, with a constant to begin with and a method for each field.

/// Methods that change one field each. What a literal in another crate would break by, a new field, only adds a method here.
macro_rules! builders {
    ($type:ident$(<$life:lifetime>)? { $($with:ident: $field:ident: $kind:ty,)* }) => {
        impl$(<$life>)? $type$(<$life>)? {
            $(
                #[doc = concat!("The same with another [`", stringify!($field), "`](field@Self::", stringify!($field), ").")]
                #[must_use]
                pub const fn $with(mut self, $field: $kind) -> Self {
                    self.$field = $field;
                    self
                }
            )*
        }
    };
}
pub(crate) use builders;
