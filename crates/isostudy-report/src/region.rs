//! Words for what is judged of a part of each mesh.

use crate::words::list;
use isostudy_design::Study;

/// `of the ground alone`, with the objects where others have no such part; `None` where all meshes are judged whole.
pub fn alone(study: &Study) -> Option<String> {
    let mut names: Vec<(&str, Vec<&str>)> = Vec::new();
    for object in &study.file.objects {
        let Some(region) = &object.region else { continue };
        match names.iter_mut().find(|(name, _)| *name == region.name) {
            Some((_, on)) => on.push(&object.name),
            None => names.push((&region.name, vec![&object.name])),
        }
    }
    match &names[..] {
        [] => None,
        [(name, on)] if on.len() == study.file.objects.len() => Some(format!("of the {name} alone")),
        _ => {
            let parts: Vec<String> =
                names.iter().map(|(name, on)| format!("of the {name} alone on {}", list(on))).collect();
            Some(list(&parts))
        }
    }
}

/// The same as a sentence about `what`, which is plural.
pub fn sentence(study: &Study, what: &str) -> Option<String> {
    Some(format!("{what} are {}.", alone(study)?))
}

/// A caption, and the sentence after it.
pub fn said(caption: impl Into<String>, study: &Study, what: &str) -> String {
    let mut text: String = caption.into();
    if let Some(sentence) = sentence(study, what) {
        text.push(' ');
        text.push_str(&sentence);
    }
    text
}
