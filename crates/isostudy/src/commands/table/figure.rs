//! A figure of tables: how good their triangles are on some surfaces, and of which kinds the worst are.

use super::places::{Part, for_each_triangle};
use super::{WORST, parts, tables_of};
use crate::memory::Limit;
use crate::source::{Inside, Options, Source};
use crate::store;
use anyhow::{Context, Result, bail};
use glam::Vec3;
use isostudy_cells::{EdgeGroups, radius_ratio};
use isostudy_extract::{BoxGrid, Execution, Extractor, presets};
use isostudy_field::{Asteroid, Terrain, TerrainCharacter};
use isostudy_mesh::Bounds;
use isostudy_report::{KindShare, TableQuality, edge_groups_figure};
use std::path::Path;

/// Cubes along the longest side of the surfaces that are looked at where none is given.
const CELLS: u32 = 64;
/// Formulas of such surfaces, inside below 0.
const FORMULAS: [(&str, &str, f32); 6] = [
    ("sphere", "sqrt(x^2 + y^2 + z^2) - 1", 1.1),
    ("torus", "sqrt((sqrt(x^2 + y^2) - 0.7)^2 + z^2) - 0.25", 1.1),
    ("rounded cube", "x^4 + y^4 + z^4 - 0.9", 1.1),
    ("gyroid", "sin(9.42*x)*cos(9.42*y) + sin(9.42*y)*cos(9.42*z) + sin(9.42*z)*cos(9.42*x)", 1.0),
    ("tangle", "x^4 - 5*x^2 + y^4 - 5*y^2 + z^4 - 5*z^2 + 11.8", 3.0),
    (
        "Marschner-Lobb",
        "0.5 - (1 - sin(1.5707963*z) + 0.25*(1 + cos(37.699112*cos(1.5707963*sqrt(x^2 + y^2)))))/2.5",
        1.0,
    ),
];

/// Draws the figure into a file, `.png` or `.svg`. Without a surface it is of our own.
///
/// # Errors
/// If a name is of no table and no method, a surface has no triangles, or the file cannot be written.
pub(super) fn write(names: &[String], given: Option<Source>, limit: Limit, path: &Path) -> Result<()> {
    let is_svg = match path.extension().and_then(|ending| ending.to_str()) {
        Some("svg") => true,
        Some("png") => false,
        _ => bail!("{}: a figure ends in .png or .svg", path.display()),
    };
    let sources = given.map_or_else(|| ours(limit), |source| Ok(vec![source]))?;
    let tables = names.iter().map(|name| quality(name, &sources, limit)).collect::<Result<Vec<_>>>()?;
    let surfaces: Vec<String> = sources.iter().map(|source| source.name.clone()).collect();
    let figure = edge_groups_figure(&tables, &surfaces, WORST)?;
    let bytes = if is_svg { figure.svg.into_bytes() } else { figure.png };
    store::write_whole(path, &bytes)
}

fn ours(limit: Limit) -> Result<Vec<Source>> {
    let options = Options {
        bounds: None,
        spacing: None,
        cells: Some(CELLS),
        isovalue: 0.0,
        inside: None,
        close: false,
        allow_open: false,
        limit,
        method: None,
        in_file: false,
    };
    let cube = |half: f32| Bounds { min: Vec3::splat(-half), max: Vec3::splat(half) };
    let mut sources = Vec::new();
    for (name, formula, half) in FORMULAS {
        let mut source = options.of_formula(formula, cube(half), name)?;
        source.name = name.into();
        sources.push(source);
    }
    let settings = TerrainCharacter::Caves.settings(3);
    let land = Bounds { min: Vec3::new(-1.0, -1.0, -0.5), max: Vec3::new(1.0, 1.0, 0.5) };
    let terrain = Terrain::try_new(settings, land)?;
    sources.push(options.of_field(Box::new(Asteroid::default()), Inside::Above, cube(1.1), "asteroid"));
    sources.push(options.of_field(Box::new(terrain), Inside::Above, land, "terrain with caves"));
    Ok(sources)
}

/// What a table, or a method whose triangles no table has, makes of surfaces.
fn quality(name: &str, sources: &[Source], limit: Limit) -> Result<TableQuality> {
    let mut ratios = Vec::new();
    let Some(tables) = tables_of(name)? else {
        for source in sources {
            ratios.extend(by_method(name, source)?);
        }
        return Ok(TableQuality { name: name.into(), ratios, kinds: Vec::new() });
    };
    let (cell, groups) = (tables[0].cell(), EdgeGroups::new(tables[0].cell()));
    let parts: Vec<Part> = parts(&tables, &groups)?;
    let label = |edges: [u8; 3]| {
        edges.map(|edge| cell.edges()[usize::from(edge)]).map(|[a, b]| format!("{a}-{b}")).join(" ")
    };
    let mut kinds: Vec<KindShare> = groups
        .all()
        .iter()
        .map(|group| KindShare { label: label(group.example), is_bad: group.is_path, shares: Vec::new() })
        .collect();
    for source in sources {
        let mut all: Vec<(f64, usize)> = Vec::new();
        for_each_triangle(source, limit, &parts, |corners, group| all.push((radius_ratio(corners), group)))
            .with_context(|| source.place())?;
        if all.is_empty() {
            bail!(source.no_surface());
        }
        ratios.extend(all.iter().map(|(ratio, _)| ratio));
        all.sort_by(|a, b| a.partial_cmp(b).expect("ratios are numbers"));
        all.truncate(WORST);
        for (number, kind) in kinds.iter_mut().enumerate() {
            let count = all.iter().filter(|(_, group)| *group == number).count();
            kind.shares.push(count as f64 / all.len() as f64);
        }
    }
    Ok(TableQuality { name: name.into(), ratios, kinds })
}

/// The radius ratios of the triangles that a method makes of a surface.
fn by_method(name: &str, source: &Source) -> Result<Vec<f64>> {
    let preset =
        presets().iter().find(|preset| preset.id == name).context("a name without a table is a method's")?;
    let grid = BoxGrid { bounds: source.bounds, spacing: source.spacing };
    let field: &dyn isostudy_field::StudyField = &*source.field;
    let found = preset.method.extract(
        &mut Extractor::new(),
        field.into(),
        &grid,
        source.isovalue,
        &Execution::default(),
    )?;
    let corners = |t| found.mesh.corners(t).map(|p| p.to_array().map(f64::from));
    Ok((0..found.mesh.triangles.len()).map(|t| radius_ratio(corners(t))).collect())
}
