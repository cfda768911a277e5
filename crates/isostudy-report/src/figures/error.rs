//! Why a figure could not be made.

/// Why figures could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FigureError {
    /// A figure could not be drawn.
    #[error("figure {figure}: {message}")]
    Drawing {
        /// The figure's name.
        figure: String,
        /// What the drawing library said.
        message: String,
    },
}
