//! Fronts on surfaces that are known, and on such as cannot be grown.

mod blobs;
mod closed;
mod faults;
mod in_boxes;
mod shapes;
mod sheets;
