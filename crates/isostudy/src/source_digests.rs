//! Digests of the sources that make each kind of result; see `build.rs`.

const MESH: &str = env!("ISOSTUDY_SOURCES_MESH");
const CELLS: &str = env!("ISOSTUDY_SOURCES_CELLS");
const DESIGN: &str = env!("ISOSTUDY_SOURCES_DESIGN");
const RESPONSES: &str = env!("ISOSTUDY_SOURCES_RESPONSES");
const FIELD: &str = env!("ISOSTUDY_SOURCES_FIELD");
const FOREIGN: &str = env!("ISOSTUDY_SOURCES_FOREIGN");
const EXTRACT: &str = env!("ISOSTUDY_SOURCES_EXTRACT");
const FINISH: &str = env!("ISOSTUDY_SOURCES_FINISH");
const TRILINEAR: &str = env!("ISOSTUDY_SOURCES_TRILINEAR");
const EXPRESSION: &str = env!("ISOSTUDY_SOURCES_EXPRESSION");
const VOLUME: &str = env!("ISOSTUDY_SOURCES_VOLUME");
const GRID: &str = env!("ISOSTUDY_SOURCES_GRID");
const SCATTERED: &str = env!("ISOSTUDY_SOURCES_SCATTERED");
const PROGRAM: &str = env!("ISOSTUDY_SOURCES_PROGRAM");
const STATISTICS: &str = env!("ISOSTUDY_SOURCES_STATISTICS");
const TABLE: &str = env!("ISOSTUDY_SOURCES_TABLE");
const TIMING: &str = env!("ISOSTUDY_SOURCES_TIMING");
const RASTER: &str = env!("ISOSTUDY_SOURCES_RASTER");
const BENCH: &str = env!("ISOSTUDY_SOURCES_BENCH");
const INFERENCE: &str = env!("ISOSTUDY_SOURCES_INFERENCE");
const REPORT: &str = env!("ISOSTUDY_SOURCES_REPORT");
const PAPER: &str = env!("ISOSTUDY_SOURCES_PAPER");
const SERVE: &str = env!("ISOSTUDY_SOURCES_SERVE");
const PAGE: &str = env!("ISOSTUDY_SOURCES_PAGE");
const CLI: &str = env!("ISOSTUDY_SOURCES_CLI");

/// What makes meshes.
pub(crate) const MESHES: &[&str] = &[
    MESH, FIELD, FOREIGN, EXPRESSION, VOLUME, GRID, SCATTERED, CELLS, EXTRACT, FINISH, TRILINEAR, PROGRAM,
    CLI,
];
/// What makes pictures of meshes.
pub(crate) const PICTURES: &[&str] = &[MESH, RASTER, CLI];
/// What makes timings.
pub(crate) const TIMINGS: &[&str] =
    &[MESH, FIELD, FOREIGN, EXPRESSION, VOLUME, GRID, SCATTERED, CELLS, EXTRACT, FINISH, PROGRAM, BENCH, CLI];
/// What makes tables, figures and the report.
pub(crate) const TABLES: &[&str] =
    &[DESIGN, RESPONSES, STATISTICS, TABLE, TIMING, INFERENCE, REPORT, PAPER, CLI, PAGE];
/// What simulates answers, and counts how they come out.
pub(crate) const SIMULATIONS: &[&str] = &[DESIGN, RESPONSES, STATISTICS, INFERENCE];
/// What makes the key.
pub(crate) const KEYS: &[&str] = &[DESIGN, CLI];
/// What makes the bundle for participants.
pub(crate) const BUNDLES: &[&str] = &[DESIGN, RESPONSES, TABLE, SERVE, CLI];
/// What makes the page.
pub(crate) const PAGES: &[&str] = &[DESIGN, CLI, PAGE];
