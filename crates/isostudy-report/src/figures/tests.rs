use super::*;
use crate::fixture::{self, Everything};
use isostudy_inference::Inputs;

/// Every tag is closed in order, attributes are quoted, and no bare `&` or `<` is left in text.
fn is_well_formed(svg: &str) -> bool {
    let mut open: Vec<&str> = Vec::new();
    let mut rest = svg;
    while let Some(start) = rest.find('<') {
        let text = &rest[..start];
        if text
            .replace("&amp;", "")
            .replace("&lt;", "")
            .replace("&gt;", "")
            .replace("&quot;", "")
            .replace("&apos;", "")
            .contains('&')
        {
            return false;
        }
        let Some(end) = rest.find('>') else { return false };
        let tag = &rest[start + 1..end];
        if tag.contains('<') || tag.matches('"').count() % 2 == 1 {
            return false;
        }
        let name = tag.trim_start_matches('/').split([' ', '/']).next().unwrap_or_default();
        if tag.starts_with('/') {
            if open.pop() != Some(name) {
                return false;
            }
        } else if !tag.ends_with('/') {
            open.push(name);
        }
        rest = &rest[end + 1..];
    }
    open.is_empty() && rest.trim().is_empty()
}

#[test]
fn the_check_itself_can_fail() {
    assert!(is_well_formed("<a b=\"c\"><d/>x &amp; y</a>"));
    for bad in ["<a>", "<a></b>", "<a b=\"c></a>", "<a>x & y</a>", "<a/>x"] {
        assert!(!is_well_formed(bad), "{bad}");
    }
}

#[test]
fn every_figure_is_there_and_sound() {
    let all = Everything::of(fixture::study());
    let figures = figures(&Results::of(&all.inputs())).unwrap();
    let expected = [
        (
            "overview",
            vec![
                "Integrated clustering over no clustering",
                "share of answers for the first: 0.5 is no preference",
            ],
        ),
        ("triangles", vec!["triangles", "120,000", "sphere", "asteroid", "bunny", "published"]),
        (
            "pass_times",
            vec!["median time, ms", "share of the whole", "published share", "body-centred, edge collapse"],
        ),
        ("radius_ratio", vec!["mean radius ratio", "simple cubic, integrated"]),
        ("aspect_ratio", vec!["mean aspect ratio", "10", "777", "simple cubic, edge collapse"]),
        ("stage_times", vec!["sampling", "bunny, without sampling", "median time, s"]),
        ("aspect_ratio_distributions", vec!["longest / shortest edge", "published ratio", "1.5"]),
        (
            "fronts",
            vec!["sphere: time and error", "bunny: time and preference", "ms from field to mesh", "worth"],
        ),
        ("contrasts", vec!["The body-centred lattice over the simple cubic lattice", "44:5:5", "84:22:56"]),
        ("answers", vec!["Q1", "Q27", "as_sp", "left of the row preferred", "18"]),
        ("preference_objects", vec!["B: clustering within body-centred", "largest possible"]),
        (
            "preference_overall",
            vec!["73 %", "wins / showings", "0.340", "1.062", "from arrangement groups", "published"],
        ),
        (
            "worths",
            vec!["Clustering within body-centred", "no clustering", "simple cubic, integrated", "log worth"],
        ),
        ("respondents", vec!["respondent 16", "10 of 27; left 19, none 0, right 8"]),
        ("prediction", vec!["ratio; fewer is better", "sphere", "share for the better"]),
    ];
    assert_eq!(figures.len(), expected.len());
    for (figure, (name, labels)) in figures.iter().zip(expected) {
        assert_eq!(figure.name, name);
        let narrow = figure.narrow.as_deref().expect("every figure of a study stands on pages");
        assert!(is_well_formed(&figure.svg) && is_well_formed(narrow), "{name}");
        assert!(
            figure.narrow_size().is_some_and(|[width, _]| width == 360) && figure.size()[0] == 1000,
            "{name}"
        );
        for label in labels {
            assert!(figure.svg.contains(&format!(">\n{label}\n</text>")), "{name}: {label}");
        }
        assert!(figure.svg.contains("DejaVu Sans, Verdana, Helvetica, Arial, sans-serif"), "{name}");
        assert!(figure.caption.ends_with('.'), "{name}");

        let reader = png::Decoder::new(std::io::Cursor::new(&figure.png)).read_info();
        let mut reader = reader.unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        assert_eq!(info.width, 2000, "{name}");
        let dark = pixels.chunks_exact(3).filter(|p| p.iter().all(|&c| c < 0x60)).count();
        assert!(dark > 2000, "{name} has text and axes");
        let viewbox = format!("viewBox=\"0 0 {} {}\"", info.width, info.height);
        assert!(figure.svg.contains(&viewbox), "{name}");
    }
}

#[test]
fn the_same_inputs_give_the_same_bytes() {
    let mut all = Everything::of(fixture::study());
    let before = figures(&Results::of(&all.inputs())).unwrap();
    all.meshes.reverse();
    assert!(figures(&Results::of(&all.inputs())).unwrap() == before);
}

#[test]
fn nothing_leaves_the_drawing_and_no_text_stands_on_another() {
    let all = Everything::of(fixture::study());
    let without = Inputs { answers: None, ..all.inputs() };
    for inputs in [all.inputs(), without] {
        for sheet in [Sheet::Wide, Sheet::Narrow] {
            for draft in drafts(&Results::of(&inputs), sheet) {
                let (name, canvas) = (draft.name, draft.canvas);
                assert_eq!(canvas.texts_outside(), Vec::<String>::new(), "{name}, {sheet:?}");
                assert_eq!(canvas.texts_on_texts(), Vec::new(), "{name}, {sheet:?}");
                let [left, right] = canvas.reach();
                assert!(left >= 0.0 && right <= sheet.width(), "{name}, {sheet:?}: {left} to {right}");
            }
        }
    }
}

/// A study with 32 methods and four objects, and records made up for it.
fn large() -> Everything {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/terrain.toml");
    let study = isostudy_design::Study::load(&path).unwrap();
    let mut all = Everything::of(fixture::study());
    let ids: Vec<_> = study.configurations.iter().map(|of| of.id.clone()).collect();
    assert!(study.methods.len() == 32 && study.file.objects.len() == 4);
    let known = all.meshes.iter().find(|mesh| mesh.purpose == isostudy_design::record::Purpose::Benchmark);
    let known = known.unwrap().clone();
    let of = all.bench.samples[0].id.clone();
    let samples: Vec<_> = all.bench.samples.iter().filter(|sample| sample.id == of).cloned().collect();
    all.meshes = ids
        .iter()
        .map(|id| isostudy_design::record::MeshRecord { id: id.clone(), ..known.clone() })
        .collect();
    all.bench.samples = ids
        .iter()
        .flat_map(|id| {
            let with = |of: &isostudy_design::record::BenchSample| isostudy_design::record::BenchSample {
                id: id.clone(),
                ..of.clone()
            };
            samples.iter().map(with).collect::<Vec<_>>()
        })
        .collect();
    all.study = study;
    all
}

#[test]
fn no_label_of_a_large_study_stands_on_another() {
    let all = large();
    let inputs = Inputs { answers: None, ..all.inputs() };
    for sheet in [Sheet::Wide, Sheet::Narrow] {
        let drafts = [
            meshes::triangles(&inputs, sheet),
            meshes::pass_times(&inputs, sheet),
            meshes::radius_ratios(&inputs, sheet),
            meshes::aspect_ratios(&inputs, sheet),
            stages::stage_times(&inputs, sheet),
            distributions::aspect_ratios(&inputs, sheet),
        ];
        for draft in drafts.into_iter().flatten() {
            let (name, canvas) = (draft.name, draft.canvas);
            assert_eq!(canvas.texts_on_texts(), Vec::new(), "{name}, {sheet:?}");
            assert_eq!(canvas.lines_on_lines(), Vec::new(), "{name}, {sheet:?}");
            assert_eq!(canvas.texts_outside(), Vec::<String>::new(), "{name}, {sheet:?}");
            let [left, right] = canvas.reach();
            assert!(left >= 0.0 && right <= sheet.width(), "{name}, {sheet:?}: {left} to {right}");
        }
    }
}

#[test]
fn no_two_methods_of_a_large_study_look_alike() {
    let all = large();
    let looks: Vec<style::Look> =
        all.study.methods.iter().map(|method| style::look(&all.study, method.id)).collect();
    for (i, look) in looks.iter().enumerate() {
        // Marks differ in black and white as well.
        let alike = looks[..i].iter().position(|of| (of.shape, of.filling) == (look.shape, look.filling));
        assert_eq!(alike, None, "{}: {look:?}", all.study.methods[i].id);
    }
    let hue = |id: &str| {
        let place = all.study.methods.iter().position(|method| method.id.to_string() == id);
        looks[place.unwrap()].hue
    };
    assert!(hue("dc") == hue("dc-in-cell") && hue("dc") == hue("dca-matched"));
    assert!(hue("bi") == hue("bir-matched") && hue("bi") != hue("dc") && hue("bi") != hue("si"));
}

#[test]
fn a_phone_shows_letters_as_large_as_those_of_its_pages() {
    let all = Everything::of(fixture::study());
    for draft in drafts(&Results::of(&all.inputs()), Sheet::Narrow) {
        // A screen of 360 pixels shows them as they are drawn, but for the margins of the page.
        assert!(draft.canvas.least_em() >= 12.0, "{}: {}", draft.name, draft.canvas.least_em());
    }
}

#[test]
fn methods_of_one_family_share_a_hue() {
    let mut study = fixture::study();
    let recipe = |kind: &str, arrangement: Option<&str>| isostudy_design::Recipe {
        kind: kind.into(),
        settings: arrangement.map(|of| ("arrangement".to_owned(), of.into())).into_iter().collect(),
    };
    let recipes = [
        recipe("cubes", None),
        recipe("tetrahedra", Some("body-centred")),
        recipe("tetrahedra", Some("simple-cubic")),
        recipe("cubes", None),
        recipe("tetrahedra", Some("body-centred")),
        recipe("surface-nets", None),
    ];
    for (method, recipe) in study.methods.iter_mut().zip(recipes) {
        method.recipe = recipe;
        method.levels.fill(None);
    }
    let of = |method: &isostudy_design::Method| {
        let look = style::look(&study, method.id);
        assert_eq!(look.shape, look.hue);
        [look.hue, look.filling]
    };
    let looks: Vec<[usize; 2]> = study.methods.iter().map(of).collect();
    assert_eq!(looks, [[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [3, 0]]);
}

#[test]
fn captions_say_what_is_left_out() {
    let all = Everything::of(fixture::study());
    let caption = meshes::aspect_ratios(&all.inputs(), Sheet::Wide).unwrap().caption;
    assert!(
        caption.contains("192 degenerate triangles, whose ratio is infinite, are left out."),
        "{caption}"
    );
    assert!(caption.contains("ss_bu 775.93, ss_su 1207.37"), "{caption}");
    let all_figures = figures(&Results::of(&all.inputs())).unwrap();
    let caption = &all_figures.iter().find(|f| f.name == "preference_overall").unwrap().caption;
    let want = "A factor of an arrangement group can reach 1, one of a clustering group 2/3, so the sum weighs the \
                arrangement half more.";
    assert!(caption.ends_with(want), "{caption}");
    let caption = meshes::pass_times(&all.inputs(), Sheet::Wide).unwrap().caption;
    assert!(caption.contains("Published times are from another machine"), "{caption}");
}

#[test]
fn objects_stand_in_rows_of_three_at_most_as_evenly_as_they_go() {
    let lengths = |objects: usize| -> Vec<usize> {
        Sheet::Wide.in_rows(&(0..objects).collect::<Vec<_>>()).iter().map(|row| row.len()).collect()
    };
    assert_eq!([1, 2, 3].map(lengths), [vec![1], vec![2], vec![3]]);
    assert_eq!([4, 5, 6].map(lengths), [vec![2, 2], vec![3, 2], vec![3, 3]]);
    assert_eq!(Sheet::Wide.in_rows(&[4, 7, 1, 0]).concat(), [4, 7, 1, 0]);
    assert_eq!(Sheet::Narrow.in_rows(&[4, 7, 1]), [[4], [7], [1]]);
}
