//! The published evaluation, to the digit.
//!
//! All twelve sphere and asteroid rows of Costen (2026), Appendix B, with the original's accumulated positions.

use std::collections::HashMap;

use glam::Vec3;
use isostudy_extract::by_lattice::{ExtractSettings, Lattice, extract};
use isostudy_extract::{Arrangement, Clustering, Counts, Execution, Extraction, Positions, Topology};
use isostudy_field::{Asteroid, Sphere, StudyField};
use isostudy_mesh::{Bounds, TriangleMesh};

/// The original's benchmark sampled with sixteen threads.
const PUBLISHED: Positions = Positions::Accumulated { chunks: 16 };

/// A row of the published table, by column.
struct Row(HashMap<String, String>);

impl Row {
    fn text(&self, column: &str) -> &str {
        &self.0[column]
    }

    fn count(&self, column: &str) -> u64 {
        self.text(column).parse().unwrap()
    }
}

fn published_rows() -> Vec<Row> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../study/paper/published_benchmark.csv");
    let table = std::fs::read_to_string(path).unwrap();
    let mut lines = table.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let rows: Vec<Row> = lines
        .map(|line| {
            Row(header.iter().map(|h| h.to_string()).zip(line.split(',').map(String::from)).collect())
        })
        .filter(|row| !row.text("id").starts_with("bs"))
        .collect();
    assert_eq!(rows.len(), 12);
    rows
}

fn lattice_of(row: &Row) -> Lattice {
    let arrangement = match row.text("id").as_bytes()[3] {
        b'b' => Arrangement::BodyCentred,
        b's' => Arrangement::SimpleCubic,
        other => panic!("{other}"),
    };
    let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    Lattice::try_new(arrangement, bounds, 0.04).unwrap()
}

fn extract_row(row: &Row) -> Extraction {
    let field: &dyn StudyField = match &row.text("id")[..2] {
        "ss" => &Sphere { radius: 1.0 },
        "as" => &Asteroid::default(),
        other => panic!("{other}"),
    };
    let clustering = match row.text("id").as_bytes()[4] {
        b'u' => Clustering::None,
        b'i' => Clustering::Integrated,
        b'p' => Clustering::EdgeCollapse,
        other => panic!("{other}"),
    };
    let topology = Topology::Published;
    let settings = ExtractSettings::default()
        .with_clustering(clustering)
        .with_topology(topology)
        .with_positions(PUBLISHED);
    extract(field, &lattice_of(row), &settings, &Execution::default()).unwrap()
}

/// Mean and population standard deviation.
fn mean_and_sd(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (mean, (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt())
}

/// Of each triangle, from its first corner: the area, and the ratio of the two sides that meet there. The original
/// measures in `f32` and adds up in `f64`.
fn areas_and_ratios(mesh: &TriangleMesh) -> (Vec<f64>, Vec<f64>) {
    (0..mesh.triangles.len())
        .map(|t| {
            let [a, b, c] = mesh.corners(t);
            let (ab, ac) = (b - a, c - a);
            let (short, long) = (ab.length().min(ac.length()), ab.length().max(ac.length()));
            (f64::from(ab.cross(ac).length() * 0.5), f64::from(long) / f64::from(short))
        })
        .unzip()
}

#[test]
fn counts_of_all_twelve_rows() {
    for row in published_rows() {
        let id = row.text("id");
        let counts = extract_row(&row).counts;
        let tetrahedra = counts.tetrahedra.unwrap();
        assert_eq!(counts.vertices, row.count("vertices"), "{id} vertices");
        assert_eq!(counts.triangles, row.count("triangles"), "{id} triangles");
        assert_eq!(
            tetrahedra.tetrahedra_evaluated,
            row.count("tetrahedra_evaluated"),
            "{id} tetrahedra evaluated"
        );
        assert_eq!(tetrahedra.tetrahedra, row.count("tetrahedra"), "{id} tetrahedra");
        assert_eq!(tetrahedra.stored_samples, row.count("stored_samples"), "{id} samples");
        assert_eq!(tetrahedra.stored_edges, row.count("stored_edges"), "{id} edges");
        assert_eq!(tetrahedra.sample_bytes, row.count("sample_bytes"), "{id} sample bytes");
        assert_eq!(tetrahedra.edge_bytes, row.count("edge_bytes"), "{id} edge bytes");
        assert_eq!(counts.vertex_bytes, row.count("vertex_bytes"), "{id} vertex bytes");
        assert_eq!(counts.index_bytes, row.count("index_bytes"), "{id} index bytes");
    }
}

fn as_published(counts: &Counts) -> u64 {
    counts.tetrahedra.unwrap().discarded_as_published
}

#[test]
fn discarded_triangles_as_published() {
    for row in published_rows() {
        let id = row.text("id");
        // The sine differs from the original's in a last bit somewhere: one triangle of 46530.
        let expected = row.count("discarded_as_published") + u64::from(id == "as_bi");
        assert_eq!(as_published(&extract_row(&row).counts), expected, "{id}");
    }
}

#[test]
fn discarded_triangles_are_those_of_the_unclustered_mesh() {
    let rows = published_rows();
    // Rows come in threes: unclustered, integrated, edge collapse.
    for group in rows.chunks(3) {
        let [unclustered, integrated, collapsed] = [0, 1, 2].map(|i| extract_row(&group[i]).counts);
        assert_eq!(unclustered.discarded_triangles, 0);
        assert_eq!(unclustered.crossings, unclustered.vertices);
        for clustered in [integrated, collapsed] {
            assert_eq!(clustered.triangles + clustered.discarded_triangles, unclustered.triangles);
            assert_eq!(clustered.crossings, unclustered.crossings);
        }
        let excess = as_published(&integrated) - integrated.discarded_triangles;
        let expected = match group[0].text("id") {
            "ss_bu" => 30_566,
            "ss_su" => 20_752,
            "as_bu" => 13_454 + 1,
            "as_su" => 9_407,
            other => panic!("{other}"),
        };
        assert_eq!(excess, expected, "{} over-count", group[1].text("id"));
        assert_eq!(as_published(&collapsed), collapsed.discarded_triangles);
    }
}

/// [`Lattice::needed_samples`] and [`Lattice::needed_edges`] as Costen (2026) has them: two wrong signs on the simple cubic
/// lattice, which make the published allocation ratio 112.75 % where it is 100 %.
pub(crate) fn needed_as_published(lattice: &Lattice) -> (u64, u64) {
    if lattice.arrangement() != Arrangement::SimpleCubic {
        return (lattice.needed_samples(), lattice.needed_edges());
    }
    let [x, y, z] = lattice.cells().map(u64::from);
    let (sides, ends) = (x * y + x * z + y * z, x + y + z);
    ((x - 1) * (y - 1) * (z - 1), 7 * x * y * z - 3 * sides + ends)
}

#[test]
fn lattice_counts_as_published_and_as_they_are() {
    for row in published_rows() {
        let lattice = lattice_of(&row);
        assert_eq!(lattice.cells(), [50; 3]);
        let wanted = (row.count("needed_samples"), row.count("needed_edges"));
        assert_eq!(needed_as_published(&lattice), wanted);
        let expected = match lattice.arrangement() {
            Arrangement::BodyCentred => (272_651, 1_832_650),
            _ => (132_651, 897_650),
        };
        assert_eq!((lattice.needed_samples(), lattice.needed_edges()), expected);
    }
}

#[test]
fn triangle_areas_to_every_printed_digit() {
    for row in published_rows() {
        let id = row.text("id");
        let (areas, _) = areas_and_ratios(&extract_row(&row).mesh);
        let (mean, sd) = mean_and_sd(&areas);
        assert_eq!(format!("{mean:.6}"), row.text("area_mean"), "{id} mean");
        assert_eq!(format!("{sd:.6}"), row.text("area_sd"), "{id} standard deviation");
        let max = areas.iter().copied().fold(0.0, f64::max);
        assert_eq!(format!("{max:.6}"), row.text("area_max"), "{id} largest");
    }
}

#[test]
fn two_sided_aspect_ratios() {
    for row in published_rows() {
        let id = row.text("id");
        let (_, ratios) = areas_and_ratios(&extract_row(&row).mesh);
        let (mean, sd) = mean_and_sd(&ratios);
        let relative = |value: f64, column: &str| {
            let published: f64 = row.text(column).parse().unwrap();
            (value / published - 1.0).abs()
        };
        match id {
            // The sphere runs through lattice points and leaves sides of no length; the published number is noise.
            "ss_bu" | "ss_su" => assert!(mean.is_nan() || mean.is_infinite(), "{id} {mean}"),
            "ss_bi" | "ss_bp" | "ss_si" | "ss_sp" => {
                let max = ratios.iter().copied().fold(0.0, f64::max);
                assert_eq!(format!("{mean:.6}"), row.text("aspect_ratio_mean"), "{id} mean");
                assert_eq!(format!("{sd:.6}"), row.text("aspect_ratio_sd"), "{id} standard deviation");
                assert_eq!(format!("{max:.6}"), row.text("aspect_ratio_max"), "{id} largest");
            }
            // The sine moves slivers, which the unclustered mean is made of.
            "as_bu" | "as_su" => assert!(relative(mean, "aspect_ratio_mean") < 2e-3, "{id} {mean}"),
            _ => {
                assert!(relative(mean, "aspect_ratio_mean") < 6e-5, "{id} mean {mean}");
                assert!(relative(sd, "aspect_ratio_sd") < 3e-4, "{id} standard deviation {sd}");
            }
        }
    }
}
