//! Why the guarded rules keep the surface a manifold.

mod certificate;
mod lemmas;
