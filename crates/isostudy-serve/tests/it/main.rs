//! The server, from outside.

#[path = "../../../../tests/http.rs"]
mod http;
mod server;
