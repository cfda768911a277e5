//! Fronts on surfaces that are known, and on such as cannot be grown.

mod probe_run;
mod shapes;
