//! The pages that people read: `index.html`, which shows a study, and the report.

mod codes;
mod glossary;
mod index;
mod report;
mod templates;
mod viewer;

pub(super) use report::{Abstract, PictureData, write as write_report};
pub(super) use templates::{caption, fits};
pub(super) use viewer::{Embedded, viewer_page};
