//! The pages that people read: `index.html`, which shows a study, and the report.

mod index;
mod report;

pub(super) use report::write as write_report;
