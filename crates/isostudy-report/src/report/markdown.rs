//! A report as Markdown.

use super::Report;
use crate::statement::Block;
use isostudy_table::markdown::escape;

impl Report {
    /// GitHub-flavoured Markdown; figures are links to `figures/<name>.svg` beside it.
    pub fn to_markdown(&self) -> String {
        let mut text = format!("# {}\n", escape(&self.title));
        text.push('\n');
        for line in &self.summary {
            text.push_str(&format!("- **{}:** {}\n", line.label, escape(&line.text)));
        }
        if let Some(methods) = &self.methods {
            text.push_str(&format!("\n## Methods\n\n{}", methods.to_markdown()));
        }
        text.push_str("\n## Participants and limits\n");
        for paragraph in &self.lead {
            text.push_str(&format!("\n{}\n", escape(paragraph)));
        }
        if !self.limits.is_empty() {
            text.push('\n');
        }
        for limit in &self.limits {
            text.push_str(&format!("- {}\n", escape(limit)));
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
