//! A report as Markdown.

use super::Report;
use crate::figure::Figure;
use crate::statement::Block;
use crate::words::counted;
use isostudy_table::markdown::escape;

impl Report {
    /// GitHub-flavoured Markdown; figures and folded tables are links to `figures/<name>.svg` and `tables/<name>.csv` beside it.
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
                let item = matches!(block, Block::Finding(_) | Block::Folded(_));
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
                    Block::Table(table) => text.push_str(&table.to_markdown()),
                    // Markdown folds nothing, and nobody reads hundreds of rows.
                    Block::Folded(table) => text.push_str(&format!(
                        "- {}, {}: [{name}](tables/{name}.csv)\n",
                        escape(&table.caption),
                        counted(table.rows.len(), "row"),
                        name = table.name
                    )),
                    Block::Figure(Figure { name, caption, .. }) => {
                        text.push_str(&format!("![{name}](figures/{name}.svg)\n\n{}\n", escape(caption)));
                    }
                }
            }
        }
        text
    }
}
