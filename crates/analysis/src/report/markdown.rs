//! A report as Markdown.

use super::{Block, Report};
use table::markdown::escape;

impl Report {
    /// GitHub-flavoured Markdown; figures are links to `figures/<name>.svg` beside it.
    pub fn to_markdown(&self) -> String {
        let mut text = format!("# {}\n", escape(&self.title));
        for paragraph in &self.lead {
            text.push_str(&format!("\n{}\n", escape(paragraph)));
        }
        for section in &self.sections {
            text.push_str(&format!("\n## {}\n", section.heading));
            let mut listing = false;
            for block in &section.blocks {
                let item = matches!(block, Block::Finding(_));
                if !(item && listing) {
                    text.push('\n');
                }
                listing = item;
                match block {
                    Block::Text(paragraph) => text.push_str(&format!("{}\n", escape(paragraph))),
                    Block::Finding(finding) => {
                        let label = crate::words::capital(finding.standing.label());
                        text.push_str(&format!("- **{label}.** {}\n", escape(&finding.text)));
                    }
                    Block::Table(table) | Block::Folded(table) => text.push_str(&table.to_markdown()),
                    Block::Figure(figure) => {
                        let caption = escape(&figure.caption);
                        text.push_str(&format!("![{caption}](figures/{}.svg)\n\n{caption}\n", figure.name));
                    }
                }
            }
        }
        text
    }
}
