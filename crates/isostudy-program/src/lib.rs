//! Extractors that run as processes of their own: a program is given samples and answers with a mesh.
//!
//! A [`Program`] is what a study says of it: command, limits. A [`Worker`] is the running process: it says once that it is
//! ready, and then answers each [`Request`] with an [`Answer`], a line of JSON each way; samples and meshes go through files.
//! The protocol, with every line and field, is in `docs/programs.md`.
//!
//! ```no_run
//! use isostudy_program::{Program, Request, Samples, Worker};
//! use std::time::Duration;
//!
//! let program = Program {
//!     command: ["python3", "../scripts/methods/example.py"].map(str::to_owned).to_vec(),
//!     base: "configs".into(),
//!     time_limit: Duration::from_secs(60),
//!     memory_limit_bytes: Some(4 << 30),
//!     sandbox: false,
//! };
//! program.check()?;
//! let mut worker = Worker::start(&program)?;
//! let mesh = worker.folder().join("mesh.ply");
//! let answer = worker.extract(&Request {
//!     samples: Samples::Values(&[0.0; 27]),
//!     size: [3, 3, 3],
//!     origin: [-1.0; 3],
//!     spacing: [1.0; 3],
//!     isovalue: 0.5,
//!     mesh: Some(&mesh),
//!     may_be_empty: true,
//! })?;
//! println!("{} triangles in {:?}", answer.triangles, answer.wall);
//! worker.finish()?;
//! # Ok::<(), isostudy_program::ProgramError>(())
//! ```
//!
//! # Samples and signs
//!
//! Samples are `f32`, x fastest: sample `(i, j, k)` is at `i + size[0] * (j + size[1] * k)` and lies at `origin + spacing * (i, j, k)`.
//! Inside is a value above the isovalue; a value equal to it is outside, and so is `NaN`. Triangles are counter-clockwise seen
//! from outside. Crate `extract` says the same of its own meshes.
//!
//! # Guaranteed
//!
//! - A program that crashes, hangs, says what nobody asked for, takes too much memory or writes a broken mesh is a
//!   [`ProgramError`] that names it and quotes the end of its standard error. Nothing panics, nothing waits beyond the time limit.
//! - After an error the caller's process is as before. [`Worker::is_running`] says whether the program may be asked again; if
//!   not, the caller starts another.
//! - When a worker is dropped its whole process group is gone, and so is its folder.
//! - A mesh that comes back has finite positions, indices within range, as many vertices and triangles as were told, lies in
//!   the samples' box or at most a cell beyond, and has a triangle unless the request says otherwise.
//!
//! # Not guaranteed
//!
//! - Without [`Program::sandbox`] a program may do whatever its user may do; only run what you trust. With it, a program may still read
//!   what its user may read.
//! - A process that leaves group and session, and removes the variable `ISOSTUDY_CHILD` from its environment, is neither counted nor
//!   ended. In a sandbox it is.
//! - Memory is looked at every 50 ms, and a process that the program starts is noticed within about a second (later where
//!   there are thousands of processes). A limit may be overstepped meanwhile. It is watched on Linux only.
//! - If the caller's process is killed, the kernel kills the programs, where the caller began with [`isostudy_foreign::wrapper`].
//!   Elsewhere they meet the end of their input. What programs started stays, unless they are in a sandbox.
//! - Nothing is said about the mesh's topology or quality, or about which way its triangles face.

mod answer;
mod error;
mod mesh_file;
mod program;
mod request;
mod sandbox;
mod worker;

pub use answer::{Answer, Ready};
pub use error::{Phase, Problem, ProgramError};
pub use isostudy_foreign::{End, Memory};
pub use program::Program;
pub use request::{Request, Samples, write_samples};
pub use worker::{LINE_LIMIT_BYTES, Worker};
