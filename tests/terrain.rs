//! The terrain study made small, from its file to its answer: fronts and choices are computed once more from the tables of times,
//! counts and distances, and chunks must be the whole mesh.

use crate::command::Folder;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// A row of a table by its columns.
type Row = BTreeMap<String, String>;

fn rows(out: &Path, table: &str) -> Vec<Row> {
    let path = out.join(format!("tables/{table}.csv"));
    let mut reader =
        csv::Reader::from_path(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    reader.deserialize().collect::<Result<_, _>>().unwrap()
}

fn number(row: &Row, column: &str) -> Option<f64> {
    row.get(column).filter(|text| !text.is_empty()).map(|text| text.parse().unwrap())
}

/// What is known of a configuration, from tables that know nothing of choices; times and errors with the intervals of the fronts.
struct Known {
    object: String,
    method: String,
    has_own_cubes: bool,
    seconds: f64,
    triangles: f64,
    error: f64,
    /// `None` where no sharp edge lies in the ground.
    sharp_edges: Option<f64>,
    radius_ratio: f64,
    /// From where to where time and error may lie.
    ranges: [[f64; 2]; 2],
}

/// What is best at something, by hand: of those that may be as good as the best by their intervals, those that are better in the other
/// of time and error, and of these the best. Equals are the study's first.
fn best<'a>(own: &[&'a Known], want: &str) -> &'a Known {
    let cost = |of: &Known| match want {
        "fastest" => of.seconds,
        "closest" => of.error,
        "edges" => of.sharp_edges.unwrap(),
        _ => -of.radius_ratio,
    };
    let least = |own: &[&'a Known], cost: &dyn Fn(&Known) -> f64| -> &'a Known {
        own.iter().copied().reduce(|best, of| if cost(of) < cost(best) { of } else { best }).unwrap()
    };
    let first = least(own, &cost);
    let Some(which) = ["fastest", "closest"].iter().position(|other| *other == want) else { return first };
    // Where times decide nothing, they take no ties apart.
    if first.ranges[0][0].is_nan() {
        return first;
    }
    let meets = |a: &Known, b: &Known, which: usize| {
        a.ranges[which][0] <= b.ranges[which][1] && b.ranges[which][0] <= a.ranges[which][1]
    };
    let close = |of: &Known| cost(of) <= 1.05 * cost(first);
    let alike: Vec<&Known> = own.iter().copied().filter(|of| meets(of, first, which) && close(of)).collect();
    let other = least(&alike, &|of| [of.error, of.seconds][which]);
    let as_good: Vec<&Known> = alike.into_iter().filter(|of| meets(of, other, 1 - which)).collect();
    least(&as_good, &cost)
}

fn known(out: &Path) -> Vec<Known> {
    let of = |table: &str, id: &str| {
        // What is judged is the ground.
        let is_own = |row: &Row| {
            row["id"] == id
                && row.get("purpose").is_none_or(|purpose| purpose == "benchmark")
                && row.get("part").is_none_or(|part| part == "ground")
        };
        rows(out, table).into_iter().find(is_own).unwrap()
    };
    let fronts = rows(out, "fronts");
    // The front of times is not there where times decide nothing; errors are the same in both.
    let range = |object: &str, method: &str, quantity: &str| {
        let front = if quantity == "x" { "time and error" } else { "triangles and error" };
        let is_own = |row: &&Row| row["object"] == object && row["front"] == front && row["method"] == method;
        let row = fronts.iter().find(is_own)?;
        let value = number(row, quantity);
        Some(["low", "high"].map(|end| number(row, &format!("{quantity}_{end}")).or(value).unwrap()))
    };
    let spacing_of_object = |id: &str| number(&of("benchmark", &format!("{id}_mc")), "spacing").unwrap();
    let configuration = |row: &Row| {
        let id = &row["id"];
        let (object, method) = id.split_once('_').unwrap();
        let (timed, accurate) = (of("benchmark", id), of("accuracy", id));
        let spacing = number(&timed, "spacing").unwrap();
        let of_object = spacing_of_object(object);
        // In cube edges of the mesh's own; the object's are meant.
        let distance = |column| Some(number(&accurate, column)? * spacing / of_object);
        Known {
            object: row["object"].clone(),
            method: method.into(),
            has_own_cubes: !method.ends_with("-matched"),
            seconds: number(&timed, "total_without_normals_median_s").unwrap(),
            triangles: number(&of("quality", id), "triangles").unwrap(),
            error: distance("distance_mean").unwrap().max(distance("distance_to_mesh_mean").unwrap()),
            sharp_edges: distance("sharp_edges_mean"),
            radius_ratio: number(&of("quality", id), "radius_ratio_mean").unwrap(),
            // Who met a budget with the cells of another is not there, and is asked nothing.
            ranges: ["x", "y"].map(|of| range(&row["object"], method, of).unwrap_or([f64::NAN; 2])),
        }
    };
    // Another look is the same mesh once more.
    rows(out, "configurations")
        .iter()
        .filter(|row| !["-flat", "-smooth"].iter().any(|look| row["id"].ends_with(look)))
        .map(configuration)
        .collect()
}

/// Whether the run was measured beside other work, as the first screen says.
fn is_busy(out: &Path) -> bool {
    fs::read_to_string(out.join("index.html")).unwrap().contains("Times decide nothing here")
}

/// What the page says before anybody scrolls: who is the best at what, once more by hand, and a picture of every method.
fn first_screen(out: &Path, known: &[Known], objects: &[&str]) {
    let labels: BTreeMap<String, String> =
        rows(out, "methods").into_iter().map(|row| (row["id"].clone(), row["method"].clone())).collect();
    // Codes are set whole, in elements of their own.
    let page = fs::read_to_string(out.join("index.html")).unwrap();
    let (first, others) = page.split_once("<span class=\"code\">").expect("codes with hyphens");
    let others = others.split("<span class=\"code\">").map(|of| of.replacen("</span>", "", 1));
    let page = first.to_owned() + &others.collect::<String>();
    let wants = [
        ("Shortest time", "fastest"),
        ("Smallest mean error, of the ground alone", "closest"),
        ("Sharp edges kept, of the ground alone", "edges"),
        ("Most regular triangles, of the ground alone", "regular"),
    ];
    for (heading, want) in wants.into_iter().filter(|(_, want)| !is_busy(out) || *want != "fastest") {
        // The title has the first part of a sentence alone.
        let begins = format!("{heading}: ");
        let said = page.split(&begins).skip(1).map(|said| said.split('<').next().unwrap());
        let said = said.max_by_key(|said| said.len()).expect(heading);
        let said = said.split(". ").next().unwrap().trim_end_matches('.');
        for object in objects {
            let own: Vec<&Known> =
                known.iter().filter(|of| of.object == *object && of.has_own_cubes).collect();
            if want == "edges" && own[0].sharp_edges.is_none() {
                continue;
            }
            let best = best(&own, want);
            let is_about = |part: &&str| part.ends_with("on every object") || part.contains(object);
            let part =
                said.split("; ").find(is_about).unwrap_or_else(|| panic!("{heading}: {object}: {said}"));
            // A tie has no winner: the set is named.
            let named = match part.contains("not distinguished are ") {
                true => best.method.clone(),
                false => format!("{} ({}) on ", best.method, labels[&best.method]),
            };
            assert!(part.contains(&named) || part.starts_with("not decided"), "{heading}: {named}: {part}");
        }
    }
    let pictured = |method: &str| page.contains(&format!(r#"<img src="figures/method_{method}.png""#));
    for method in labels.keys() {
        assert_eq!(pictured(method), !method.ends_with("-matched"), "{method}");
    }
    // Names of fifteen methods leave no room for their bars.
    let svg = fs::read_to_string(out.join("figures/triangles.svg")).unwrap();
    assert!(svg.contains(">\nbir-matched\n<") && !svg.contains("relaxed and matched"), "{svg}");
    let matched = "Spacings were chosen for snapmc-matched, bi-matched, bir-matched, si-matched, nets-matched and dc-matched to have as many";
    assert!(page.contains(matched));
}

#[test]
fn the_small_terrain_study_answers_from_its_own_numbers() {
    let folder = Folder::new();
    let out = folder.path("out");
    let configs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs");
    let text = fs::read_to_string(configs.join("terrain-quick.toml")).unwrap();
    let text = text.replace("cpu/x86-64-v3.toml", "target.toml");
    folder.write("study.toml", &text);
    folder.write("target.toml", fs::read(configs.join("cpu/x86-64-v3.toml")).unwrap());
    let run = folder.succeed(&["study", "study.toml", "--out", "out"]);
    assert!(run.stdout.contains("index.html"), "{}", run.stdout);
    let known = known(&out);
    let objects = ["hills", "cliffs", "caves", "building in rock"];
    assert_eq!(known.len(), 14 * objects.len());

    let fronts = rows(&out, "fronts");
    for object in objects {
        for front in ["time and error", "triangles and error"] {
            let cost =
                |of: &Known| [if front == "time and error" { of.seconds } else { of.triangles }, of.error];
            let placed: Vec<&Row> =
                fronts.iter().filter(|row| row["object"] == object && row["front"] == front).collect();
            // Who met a budget with the very cells of another has no place of its own.
            let of_row =
                |row: &&Row| known.iter().find(|of| of.object == object && of.method == row["method"]);
            let own: Vec<&Known> = placed.iter().map(|row| of_row(row).unwrap()).collect();
            // Beside other work nothing is said of times.
            if is_busy(&out) && front == "time and error" {
                assert!(own.is_empty(), "{object}: {} in the front", own.len());
                continue;
            }
            assert!((8..=14).contains(&own.len()), "{object}: {} in the front", own.len());
            for (row, point) in placed.iter().zip(&own) {
                let at = cost(point);
                let beats = |by: [f64; 2]| by[0] <= at[0] && by[1] <= at[1] && by != at;
                let is_beaten = own.iter().any(|other| beats(cost(other)));
                let said = row["standing"] != "on the front";
                assert_eq!(said, is_beaten, "{object}, {front}: {}", row["method"]);
            }
        }
    }

    for (want, called) in [
        ("fastest", "the shortest time"),
        ("closest", "the smallest mean error, of the ground alone"),
        ("edges", "sharp edges kept: the smallest mean error at them, of the ground alone"),
        ("regular", "the most regular triangles, of the ground alone"),
    ] {
        // Not where the run was measured beside other work, which the first screen says.
        let Some(row) = rows(&out, "choices").into_iter().find(|row| row["want"] == called) else {
            assert_eq!(want, "fastest");
            assert!(is_busy(&out));
            continue;
        };
        for (object, id) in objects.iter().zip(["hi", "cl", "ca", "bu"]) {
            let cell = &row[id];
            let own = known.iter().filter(|of| of.object == *object && of.has_own_cubes);
            // The edges of walls are no edges of the ground.
            if cell.is_empty() {
                assert!(want == "edges" && own.clone().all(|of| of.sharp_edges.is_none()));
                continue;
            }
            let best = best(&own.collect::<Vec<_>>(), want);
            let said = cell.split([',', ' ']).next().unwrap();
            assert_eq!(said, best.method, "{object}, {want}: {cell}");
        }
    }

    first_screen(&out, &known, &objects);

    // Chunks of every method are the whole mesh, to the bit.
    let chunks = rows(&out, "chunks");
    let made: Vec<&str> = chunks.iter().map(|row| row["id"].as_str()).collect();
    for method in ["mc", "mc33", "snapmc", "bi", "bi-relaxed", "si", "nets-manifold", "dc-in-cell"] {
        for object in ["hi", "cl", "ca", "bu"] {
            assert!(made.contains(&format!("{object}_{method}").as_str()), "{object}_{method}: {made:?}");
        }
    }
    for row in &chunks {
        assert_eq!(
            (row["open_seam_edges"].as_str(), row["is_whole"].as_str()),
            ("0", "yes"),
            "{}",
            row["id"]
        );
        assert!(number(row, "chunk_ms").unwrap() > 0.0 && number(row, "edit_ms").unwrap() > 0.0);
    }
    // From stored samples, the same chunks and edits; what lies between the samples is asked for by some.
    let stored = rows(&out, "stored");
    // Not of methods that differ by their look alone.
    assert_eq!(stored.len(), 8 * objects.len());
    for row in &stored {
        let method = row["id"].split_once('_').unwrap().1;
        let asks =
            if ["bi", "bi-relaxed", "dc-in-cell"].contains(&method) { "values between" } else { "samples" };
        assert_eq!(row["asks_for"], asks, "{method}");
        for column in ["whole_ms", "chunk_ms", "edit_ms"] {
            assert!(number(row, column).unwrap() > 0.0, "{method}: {column}");
        }
    }
    // All methods are asked the same edits.
    let edits = |id: &str| {
        let text = fs::read_to_string(out.join(format!("bench/chunks/{id}.json"))).unwrap();
        let times: serde_json::Value = serde_json::from_str(&text).unwrap();
        times["edit_chunks"].clone()
    };
    for object in ["hi", "cl", "ca", "bu"] {
        let of_cubes = edits(&format!("{object}_mc"));
        assert_eq!(of_cubes.as_array().unwrap().len(), 10);
        assert_eq!(edits(&format!("{object}_mc33")), of_cubes, "{object}");
        assert_eq!(edits(&format!("{object}_snapmc")).as_array().unwrap().len(), 10);
    }
    for page in ["index.html", "report.html"] {
        let text = fs::read_to_string(out.join(page)).unwrap();
        assert!(text.contains(r##"href="#decision""##), "{page}");
        assert!(text.contains("The best method for each object and purpose"), "{page}");
    }
    let faults = folder.succeed(&["design", "check", "study.toml"]);
    assert!(faults.stdout.contains("no faults"), "{}", faults.stdout);
    liked(&folder, &text);
}

/// Everybody likes dual contouring on the building and surface nets elsewhere, where they see them, and nothing else.
fn liked(folder: &Folder, text: &str) {
    let study: toml::Table = text.parse().unwrap();
    let mut long = String::from("participant,question,left,right,choice\n");
    for person in 0..24 {
        for comparison in study["comparisons"].as_array().unwrap() {
            let text = |key: &str| comparison[key].as_str().unwrap();
            let (mut left, mut right) = (text("left"), text("right"));
            if person % 2 == 1 {
                (left, right) = (right, left);
            }
            let is_liked = |id: &str| {
                id == "bu_dc-in-cell" || id.ends_with("_nets-manifold") && id != "bu_nets-manifold"
            };
            let choice = match (is_liked(left), is_liked(right)) {
                (true, _) => "left",
                (_, true) => "right",
                _ => "none",
            };
            long += &format!("p{person},{},{left},{right},{choice}\n", text("question"));
        }
    }
    folder.write("answers.csv", &long);
    folder.write("study.toml", format!("{text}\n[responses]\nfile = \"answers.csv\"\n"));
    let run = folder.succeed(&["study", "study.toml", "--out", "out"]);
    assert!(!run.stderr.contains("meshes          120 of"), "nothing is extracted again: {}", run.stderr);
    let rows = rows(&folder.path("out"), "choices");
    let liked = rows.iter().find(|row| row["want"] == "the look that people like most").unwrap();
    let said = ["hi", "cl", "ca", "bu"].map(|object| liked[object].split([',', ' ']).next().unwrap());
    // Chosen by everybody in each question that shows them.
    assert_eq!(said, ["nets-manifold", "nets-manifold", "nets-manifold", "dc-in-cell"]);
    let report = fs::read_to_string(folder.path("out/report.md")).unwrap();
    assert!(report.contains("the look that people like most"), "{report}");
    // Nobody compared these two with the others, on the building, which has its scale all the same.
    assert!(report.contains("No answers join nets-flat and nets-smooth to the other methods."), "{report}");
}

/// docs/terrain.md has the rows that were published, and no others.
#[test]
fn pages_say_what_was_published() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let read = |path: &str| fs::read_to_string(root.join(path)).unwrap();
    let published = read("results/published/terrain/choices.md");
    let rows: Vec<&str> = published.lines().filter(|line| line.starts_with('|')).collect();
    assert_eq!(rows.len(), 2 + csv_rows("choices").len());
    let made = read("results/published/terrain/made.txt");
    let page = read("docs/terrain.md");
    let block = between(&page, "choices");
    let said: Vec<&str> = block.lines().filter(|line| line.starts_with('|')).collect();
    assert_eq!(said, rows);
    assert!(block.contains(&format!("Measured {}.", made.lines().last().unwrap())), "{block}");
    // Whole rows of the decision; and conclusions, by what the claims say of time.
    for line in csv_rows("decision") {
        let cells: Vec<&str> = ["want", "objects", "take", "why", "cost"].map(|column| &*line[column]).into();
        let row = format!("| {} |", cells.join(" | "));
        assert!(page.contains(&row), "{row}");
    }
    let conclusion = |text: &str| {
        let row = page.lines().find(|line| line.starts_with(&format!("| {text} |"))).unwrap();
        row.trim_end_matches(" |").rsplit("| ").next().unwrap().to_owned()
    };
    for (id, text) in [
        ("vertex_integrated", "Integrated clustering lengthens the vertex pass"),
        ("geometry_integrated", "Integrated clustering shortens the geometry pass"),
        ("vertex_edge_collapse", "Edge collapse shortens the vertex pass"),
        ("geometry_edge_collapse", "Edge collapse lengthens the geometry pass"),
        ("arrangement_vertex", "The body-centred lattice lengthens the vertex pass"),
        ("arrangement_geometry", "The body-centred lattice lengthens the geometry pass"),
    ] {
        let claim = csv_rows("claims").into_iter().find(|row| row["id"] == id).unwrap();
        // The interval of the change decides, with the run's noise.
        let (_, numbers) = claim["reason"].split_once("interval over rounds ").unwrap();
        let mut numbers = numbers.split([' ', '%']).filter_map(|word| word.parse::<f64>().ok());
        let [low, high, noise] = [(); 3].map(|()| numbers.next().unwrap());
        let published: f64 = claim["published"].parse().unwrap();
        let want = match (low > noise || high < -noise, published * low > 0.0) {
            (false, _) => "open",
            (true, true) => "yes",
            (true, false) => "no",
        };
        assert_eq!(conclusion(text), want, "{text}: {}", claim["reason"]);
    }
}

/// What stands between the marks of a page.
fn between<'t>(page: &'t str, name: &str) -> &'t str {
    let (_, rest) = page.split_once(&format!("<!-- {name} -->")).unwrap();
    rest.split_once(&format!("<!-- end of {name} -->")).unwrap().0
}

/// README and the pages that recommend say the same, and the command takes the same where nobody says a method.
#[test]
fn one_recommendation_stands_everywhere() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let read = |path: &str| fs::read_to_string(root.join(path)).unwrap();
    let readme = read("README.md");
    let recommended = between(&readme, "take");
    for page in ["docs/methods.md", "docs/terrain.md", "docs/engine.md"] {
        assert_eq!(between(&read(page), "take"), recommended.replace("docs/lod.md", "lod.md"), "{page}");
    }
    let unsure = recommended.lines().find(|line| line.contains("you do not know")).unwrap();
    let default = unsure.split('`').nth(1).unwrap();
    let folder = Folder::new();
    let ball = "extract --field x^2+y^2+z^2-1 --bounds=-1.2,-1.2,-1.2,1.2,1.2,1.2 --cells 20 -o";
    for (name, method) in [("asked.ply", vec!["--method", default]), ("default.ply", vec![])] {
        let arguments: Vec<&str> = ball.split(' ').chain([name]).chain(method).collect();
        folder.succeed(&arguments);
    }
    assert!(fs::read(folder.path("asked.ply")).unwrap() == fs::read(folder.path("default.ply")).unwrap());
    // And engine.md has code that takes what the table says.
    let engine = read("docs/engine.md");
    let methods = recommended.lines().skip(3).filter_map(|line| line.split('`').nth(1));
    for method in methods {
        assert!(engine.contains(&format!("\"{method}\"")), "{method}");
    }
    // A newcomer reads README in some minutes.
    let words = readme.split_whitespace().count();
    assert!(words <= 1000, "{words}");
}

/// A published table of the terrain study.
fn csv_rows(table: &str) -> Vec<Row> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let path = root.join(format!("results/published/terrain/{table}.csv"));
    csv::Reader::from_path(path).unwrap().deserialize().collect::<Result<_, _>>().unwrap()
}

/// The prices in README's first table, once more from the published tables.
#[test]
fn readmes_prices_follow_from_what_was_published() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let readme = fs::read_to_string(root.join("README.md")).unwrap();
    let value = |table: &str, id: &str, column: &str| -> f64 {
        let rows = csv_rows(table);
        let is_own =
            |row: &&Row| row["id"] == id && row.get("purpose").is_none_or(|purpose| purpose == "benchmark");
        // The ground stands after the whole.
        number(rows.iter().rfind(is_own).unwrap(), column).unwrap()
    };
    let objects = ["hi", "cl", "ca", "bu"];
    let each = |of: &dyn Fn(&str) -> f64| -> [f64; 2] {
        let all = objects.map(of);
        [all.iter().copied().fold(f64::INFINITY, f64::min), all.iter().copied().fold(0.0, f64::max)]
    };
    let ratio = |table: &str, column: &str, method: &str| {
        each(&|o| value(table, &format!("{o}_{method}"), column) / value(table, &format!("{o}_mc"), column))
    };
    let error = |id: String| {
        value("accuracy", &id, "distance_mean").max(value("accuracy", &id, "distance_to_mesh_mean"))
    };
    let worse = |method: &str| each(&|o| error(format!("{o}_{method}")) / error(format!("{o}_mc")));
    let row = |method: &str| {
        let of_method =
            |line: &&str| line.split('|').nth(2).is_some_and(|cell| cell.trim() == format!("`{method}`"));
        readme.lines().find(of_method).unwrap_or_else(|| panic!("{method} has no row"))
    };
    for method in ["nets-manifold", "dc-in-cell", "bi-relaxed", "snapmc"] {
        let [low, high] = ratio("chunks", "chunk_ms", method);
        let said = format!("{low:.1} to {high:.1} times the time per chunk");
        let same = format!("{low:.1} times the time per chunk");
        assert!(row(method).contains(&said) || row(method).contains(&same), "{method}: {said}");
    }
    assert!(
        row("nets-manifold").contains(&format!("up to {:.1} times the error", worse("nets-manifold")[1]))
    );
    assert!(row("snapmc").contains(&format!("up to {:.2} times the error", worse("snapmc")[1])));
    let [low, high] = worse("bi-relaxed");
    assert!(
        row("bi-relaxed").contains(&format!("{low:.2} to {high:.2} of the error of `mc`")),
        "{low} {high}"
    );
    let [low, high] = worse("cms");
    let edges = value("accuracy", "bu_cms", "sharp_edges_mean");
    let said = format!("It has {low:.2} to {high:.2} of `mc`'s error, {edges:.3} cube edges at sharp edges.");
    let [low, high] = ratio("benchmark", "total_without_normals_s", "cms");
    let price = format!("It takes {low:.1} to {high:.1} times the time of `mc`, without chunks.");
    assert!(row("cms").contains(&said) && row("cms").contains(&price), "{said} {price}");
    assert!(objects.iter().all(|o| value("topology", &format!("{o}_cms"), "self_intersections") == 0.0));
    let [most, least] = ratio("quality", "triangles", "snapmc").map(|ratio| 100.0 * (1.0 - ratio));
    assert!(row("snapmc").contains(&format!("{least:.0} to {most:.0} % fewer than `mc`")), "{least} {most}");
    let [edges, of_cubes] = ["bu_dc-in-cell", "bu_mc"].map(|id| value("accuracy", id, "sharp_edges_mean"));
    let said = format!(
        "{edges:.3} cube edges of error at the sharp edges of the building, where `mc` has {of_cubes:.2}"
    );
    assert!(row("dc-in-cell").contains(&said), "{said}");
    let has_regions = csv_rows("topology")[0].contains_key("self_intersections_judged");
    let column = if has_regions { "self_intersections_judged" } else { "self_intersections" };
    let pairs = value("topology", "bu_dc-in-cell", column);
    // What stands beside it on the page, of the methods that it does not recommend.
    for object in objects {
        let [own, beside] = ["mc-edge-groups", "mc"]
            .map(|method| value("quality", &format!("{object}_{method}"), "radius_ratio_mean"));
        assert!(own > beside, "{object}: {own} {beside}");
    }
    for object in ["cl", "ca", "bu"] {
        let [own, beside] = ["dc", "dc-in-cell"].map(|method| format!("{object}_{method}"));
        let edges = |id: &str| value("accuracy", id, "sharp_edges_mean");
        assert!(edges(&own) < edges(&beside), "{object}");
        assert!(value("topology", &own, column) > value("topology", &beside, column), "{object}");
    }
    // Nobody is shown to be faster than these two, by either clock.
    let of_time = |row: &Row| {
        let ends = ["", " for a chunk", " for an edit, in chunks", " from stored samples"];
        let stored = [" for a chunk from stored samples", " for an edit from stored samples"];
        ends.iter().chain(&stored).any(|end| row["want"] == format!("the shortest time{end}"))
    };
    // `choices` has room for four names.
    let decisions: Vec<Row> = csv_rows("decision").into_iter().filter(of_time).collect();
    let wants: BTreeSet<&str> = decisions.iter().map(|row| &*row["want"]).collect();
    assert_eq!(wants.len(), 6);
    for row in decisions {
        // Of all objects of the row, without those that win on some of them.
        let named = row["take"].split("; ").next().unwrap();
        let is_named = named.split(" = ").any(|of| ["mc", "mc-edge-groups"].contains(&of));
        assert!(is_named, "{}, {}: {named}", row["objects"], row["want"]);
    }
    assert!(row("dc-in-cell").contains(&format!("{pairs} pairs of triangles intersect there")), "{pairs}");
}

/// docs/terrain.md says how many people its questionnaire takes, as the command prints it.
#[test]
fn pages_say_how_many_people_find_a_preference() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let page = fs::read_to_string(root.join("docs/terrain.md")).unwrap();
    let block = between(&page, "power");
    let folder = Folder::new();
    let config = root.join("configs/terrain.toml");
    let run = |arguments: &[&str]| {
        let all = ["design", "power", config.to_str().unwrap(), "--shares", "0.69", "--participants"];
        folder.succeed(&[&all[..], arguments, &["--out", "power"]].concat());
        let mut rows = csv::Reader::from_path(folder.path("power/power_by_kind.csv")).unwrap();
        rows.deserialize().map(Result::unwrap).collect::<Vec<Row>>()
    };
    let (plain, by_side) = (run(&["36,54,72,252"]), run(&["36", "--side-bias", "1.5"]));
    let kinds = [
        ("two methods on all objects", "methods as a whole", "4"),
        ("two methods on one object", "methods on one object", "1"),
        ("two looks on the building", "methods as a whole", "1"),
    ];
    for (name, over, questions) in kinds {
        let of = |rows: &[Row]| {
            let own = |row: &&Row| row["over"] == over && row["questions"] == questions;
            rows.iter().find(own).unwrap().clone()
        };
        let (plain, by_side) = (of(&plain), of(&by_side));
        let mut cells: Vec<&str> = ["36", "54", "72", "252"].map(|n| &*plain[&format!("power_{n}")]).into();
        cells.push(&by_side["power_36"]);
        let line = format!("| {name} | {} |", cells.join(" | "));
        assert!(block.contains(&line), "{line}");
    }
}
