//! The page that shows any two meshes side by side: one file that asks for nothing else.

use super::templates::environment;
use anyhow::Result;
use base64::Engine;
use isostudy_design::config::StudySection;
use minijinja::context;
use minijinja::value::Serde;
use serde::Serialize;

/// A module in the page, compressed.
pub(in crate::pipeline) struct Embedded {
    /// What others import it by.
    pub(in crate::pipeline) name: &'static str,
    /// Its text, gzipped.
    pub(in crate::pipeline) bytes: Vec<u8>,
}

/// A module as the template sees it.
#[derive(Serialize)]
struct Module<'a> {
    name: &'a str,
    text: String,
}

/// The page's own modules, each with what it is imported by.
const OWN: [(&str, &str); 11] = [
    ("viewer/colours.js", include_str!("viewer/colours.js")),
    ("viewer/difference.js", include_str!("viewer/difference.js")),
    ("viewer/keys.js", include_str!("viewer/keys.js")),
    ("viewer/link.js", include_str!("viewer/link.js")),
    ("viewer/main.js", include_str!("viewer/main.js")),
    ("viewer/material.js", include_str!("viewer/material.js")),
    ("viewer/modes.js", include_str!("viewer/modes.js")),
    ("viewer/nearest.js", include_str!("viewer/nearest.js")),
    ("viewer/numbers.js", include_str!("viewer/numbers.js")),
    ("viewer/scene.js", include_str!("viewer/scene.js")),
    ("viewer/surface.js", include_str!("viewer/surface.js")),
];

/// The page. `catalogue` is JSON, `library` are the modules that draw, `meshes` are gzipped glTF.
pub(in crate::pipeline) fn viewer_page(
    study: &StudySection,
    catalogue: &str,
    library: &[Embedded],
    meshes: &[Vec<u8>],
    licence: &str,
) -> Result<String> {
    let text = |bytes: &[u8]| base64::engine::general_purpose::STANDARD.encode(bytes);
    let library: Vec<Module<'_>> =
        library.iter().map(|of| Module { name: of.name, text: text(&of.bytes) }).collect();
    let own: Vec<Module<'_>> =
        OWN.iter().map(|&(name, source)| Module { name, text: source.into() }).collect();
    Ok(environment()?.get_template("viewer.html")?.render(context! {
        study => Serde(study),
        catalogue => in_script(catalogue),
        library => Serde(&library),
        modules => Serde(&own),
        meshes => meshes.iter().map(|of| text(of)).collect::<Vec<_>>(),
        licence => licence,
        version => env!("CARGO_PKG_VERSION"),
    })?)
}

/// JSON that ends no script element.
fn in_script(json: &str) -> String {
    json.replace('<', "\\u003c")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn study() -> StudySection {
        StudySection { id: "s".into(), title: "A <b> study".into(), seed: 1 }
    }

    #[test]
    fn nothing_in_the_catalogue_ends_its_script() {
        let page = viewer_page(&study(), r#"{"label":"</script><b>"}"#, &[], &[], "MIT").unwrap();
        assert!(page.contains(r#"{"label":"\u003c/script>\u003cb>"}"#) && page.contains("A &lt;b&gt; study"));
        assert_eq!(page.matches("<script").count(), page.matches("</script>").count());
    }

    #[test]
    fn modules_import_each_other_by_names_that_are_there() {
        let known = |name: &str| name.starts_with("three") || OWN.iter().any(|(own, _)| *own == name);
        let mut imports = 0;
        for (module, text) in OWN {
            for rest in text.split(" from '").skip(1) {
                let name = rest.split('\'').next().unwrap_or_default();
                assert!(known(name), "{module} imports {name}");
                imports += 1;
            }
            assert!(!text.contains("</script") && !text.contains("<!--"), "{module} would end its script");
        }
        assert!(imports > 10, "{imports}");
    }
}
