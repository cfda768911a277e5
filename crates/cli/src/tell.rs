//! Lines on standard error that end nothing where they cannot be written: on a full disk, or to a reader that has gone.

/// As `eprintln!`, which panics there.
macro_rules! tell {
    ($($words:tt)*) => {
        drop(std::io::Write::write_fmt(&mut std::io::stderr(), format_args!("{}\n", format_args!($($words)*))))
    };
}
