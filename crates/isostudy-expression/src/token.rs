//! From text to numbers, names and signs.

use crate::ExpressionError;

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Token {
    Number(f32),
    Name(String),
    /// One of `+ - * / % ^ ( ) ,`.
    Sign(char),
    End,
}

impl Token {
    /// For messages.
    pub(crate) fn describe(&self) -> String {
        match self {
            Self::Number(value) => format!("`{value}`"),
            Self::Name(name) => format!("`{}`", shortened(name)),
            Self::Sign(sign) => format!("`{sign}`"),
            Self::End => "the end".to_owned(),
        }
    }
}

/// All tokens, each with the column it starts in, the end last.
pub(crate) fn tokens(text: &str) -> Result<Vec<(Token, usize)>, ExpressionError> {
    let characters: Vec<char> = text.chars().collect();
    let mut tokens = Vec::new();
    let mut at = 0;
    while at < characters.len() {
        let (character, column) = (characters[at], at + 1);
        let length = |belongs: fn(char) -> bool| characters[at..].iter().take_while(|c| belongs(**c)).count();
        match character {
            c if c.is_whitespace() => at += 1,
            '+' | '-' | '*' | '/' | '%' | '^' | '(' | ')' | ',' => {
                // Powers are written both ways.
                let is_power = character == '*' && characters.get(at + 1) == Some(&'*');
                tokens.push((Token::Sign(if is_power { '^' } else { character }), column));
                at += if is_power { 2 } else { 1 };
            }
            c if c.is_ascii_digit() || c == '.' => {
                let end = at + number_length(&characters[at..]);
                let number: String = characters[at..end].iter().collect();
                let value = number.parse::<f32>().ok().filter(|v| v.is_finite());
                let wrong = || ExpressionError::Number { column, text: shortened(&number) };
                tokens.push((Token::Number(value.ok_or_else(wrong)?), column));
                at = end;
            }
            c if c.is_ascii_alphabetic() || c == '_' => {
                let end = at + length(|c| c.is_ascii_alphanumeric() || c == '_');
                tokens.push((Token::Name(characters[at..end].iter().collect()), column));
                at = end;
            }
            character => return Err(ExpressionError::Character { column, character }),
        }
    }
    tokens.push((Token::End, characters.len() + 1));
    Ok(tokens)
}

/// Digits and dots, and an exponent if digits follow: in `2e` the `e` is a name.
fn number_length(text: &[char]) -> usize {
    let digits = |from: usize| text[from..].iter().take_while(|c| c.is_ascii_digit()).count();
    let mut end = text.iter().take_while(|c| c.is_ascii_digit() || **c == '.').count();
    if matches!(text.get(end), Some('e' | 'E')) {
        let sign = usize::from(matches!(text.get(end + 1), Some('+' | '-')));
        let exponent = digits((end + 1 + sign).min(text.len()));
        end += if exponent > 0 { 1 + sign + exponent } else { 0 };
    }
    end
}

pub(crate) fn shortened(text: &str) -> String {
    text.chars().take(40).collect()
}
