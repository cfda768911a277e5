//! What errors say, each case in a line. Written here so that the library needs no crate that derives it.

/// Says the cases of an error in words, and which other errors become one of its cases.
macro_rules! in_words {
    (
        $error:ident { $($case:pat => $text:literal $(, $value:expr)*;)+ }
        $(from { $($cause:ty => $becomes:path),+ })?
    ) => {
        impl std::fmt::Display for $error {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                match self {
                    $($case => write!(f, $text $(, $value)*),)+
                }
            }
        }

        impl std::error::Error for $error {}

        $($(impl From<$cause> for $error {
            fn from(cause: $cause) -> Self {
                $becomes(cause)
            }
        })+)?
    };
}

pub(crate) use in_words;
