//! Precedence climbing (Pratt 1973) from tokens to fidget's graph.

use fidget_core::Context;
use fidget_core::context::Node;

use crate::ExpressionError;
use crate::functions::arity;
use crate::noise_call::{self, NOISES, NoiseCall};
use crate::token::{Token, shortened, tokens};

/// Levels of brackets, functions, signs and powers. A level takes a few hundred bytes of stack.
const DEPTH_LIMIT: usize = 200;
/// Bytes of text.
const TEXT_LIMIT: usize = 1 << 16;
/// Up to here a power is a product.
const PRODUCT_LIMIT: f32 = 64.0;

/// Binding powers, the loosest first.
const SUM: u8 = 1;
const PRODUCT: u8 = 2;
const SIGN: u8 = 3;
const POWER: u8 = 4;

/// The value of a formula, and its calls of noise, inner ones first.
pub(crate) fn parse(text: &str, context: &mut Context) -> Result<(Node, Vec<NoiseCall>), ExpressionError> {
    if text.len() > TEXT_LIMIT {
        return Err(ExpressionError::TooLong { bytes: text.len(), limit: TEXT_LIMIT });
    }
    let mut parser = Parser { tokens: tokens(text)?, at: 0, depth: 0, calls: Vec::new(), context };
    let root = parser.expression(SUM)?;
    match parser.peek() {
        Token::End => Ok((root, parser.calls)),
        _ => Err(parser.unexpected("an operator or the end")),
    }
}

struct Parser<'a> {
    tokens: Vec<(Token, usize)>,
    at: usize,
    depth: usize,
    calls: Vec<NoiseCall>,
    context: &'a mut Context,
}

impl Parser<'_> {
    fn peek(&self) -> &Token {
        &self.tokens[self.at].0
    }

    fn column(&self) -> usize {
        self.tokens[self.at].1
    }

    /// Past the token, which is not the end.
    fn take(&mut self) -> Token {
        self.at += 1;
        self.tokens[self.at - 1].0.clone()
    }

    fn take_sign(&mut self, sign: char) -> bool {
        let is_there = *self.peek() == Token::Sign(sign);
        self.at += usize::from(is_there);
        is_there
    }

    fn unexpected(&self, wanted: &'static str) -> ExpressionError {
        ExpressionError::Unexpected { column: self.column(), found: self.peek().describe(), wanted }
    }

    /// An operand and all operators after it that bind at least as tightly as `least`.
    fn expression(&mut self, least: u8) -> Result<Node, ExpressionError> {
        self.depth += 1;
        if self.depth > DEPTH_LIMIT {
            return Err(ExpressionError::TooDeep { column: self.column(), limit: DEPTH_LIMIT });
        }
        let mut left = self.operand()?;
        while let Token::Sign(sign) = *self.peek() {
            let power = match sign {
                '+' | '-' => SUM,
                '*' | '/' | '%' => PRODUCT,
                '^' => POWER,
                _ => break,
            };
            if power < least {
                break;
            }
            self.at += 1;
            // Powers bind from the right, and a sign may follow: 2^-1.
            let right = self.expression(if sign == '^' { SIGN } else { power + 1 })?;
            left = self.binary(sign, left, right)?;
        }
        self.depth -= 1;
        Ok(left)
    }

    fn operand(&mut self) -> Result<Node, ExpressionError> {
        let column = self.column();
        if *self.peek() == Token::End {
            return Err(self.unexpected("a number, a name or `(`"));
        }
        match self.take() {
            Token::Number(value) => Ok(self.context.constant(value)),
            Token::Name(name) if *self.peek() == Token::Sign('(') => self.call(&name, column),
            Token::Name(name) => self.name(&name, column),
            Token::Sign('(') => {
                let inner = self.expression(SUM)?;
                if self.take_sign(')') { Ok(inner) } else { Err(self.unexpected("`)` or an operator")) }
            }
            Token::Sign('+') => self.expression(SIGN),
            Token::Sign('-') => {
                let operand = self.expression(SIGN)?;
                sound(self.context.neg(operand))
            }
            _ => {
                self.at -= 1;
                Err(self.unexpected("a number, a name or `(`"))
            }
        }
    }

    fn name(&mut self, name: &str, column: usize) -> Result<Node, ExpressionError> {
        use std::f32::consts;
        Ok(match name {
            "x" => self.context.x(),
            "y" => self.context.y(),
            "z" => self.context.z(),
            "pi" => self.context.constant(consts::PI),
            "tau" => self.context.constant(consts::TAU),
            "e" => self.context.constant(consts::E),
            _ => return Err(ExpressionError::Name { column, name: shortened(name) }),
        })
    }

    fn binary(&mut self, sign: char, a: Node, b: Node) -> Result<Node, ExpressionError> {
        if let Some(value) = self.folded(sign, a, b) {
            return Ok(self.context.constant(value));
        }
        sound(match sign {
            '+' => self.context.add(a, b),
            '-' => self.context.sub(a, b),
            '*' => self.context.mul(a, b),
            '/' => self.context.div(a, b),
            '%' => self.context.modulo(a, b),
            _ => return self.power(a, b),
        })
    }

    /// What arithmetic makes of two constants, or of anything and what is no number. fidget would take 0 times whatever
    /// for 0, and 0 divided by it.
    fn folded(&self, sign: char, a: Node, b: Node) -> Option<f32> {
        let (a, b) = (self.context.get_const(a).ok(), self.context.get_const(b).ok());
        if sign != '^' && [a, b].into_iter().flatten().any(f32::is_nan) {
            return Some(f32::NAN);
        }
        let (a, b) = a.zip(b)?;
        match sign {
            '+' => Some(a + b),
            '-' => Some(a - b),
            '*' => Some(a * b),
            '/' => Some(a / b),
            '%' => Some(a.rem_euclid(b)),
            _ => None,
        }
    }

    /// A product where the exponent is a small whole number; a root where it is a half.
    fn power(&mut self, base: Node, exponent: Node) -> Result<Node, ExpressionError> {
        match self.context.get_const(exponent) {
            Ok(n) if n.fract() == 0.0 && n.abs() <= PRODUCT_LIMIT => {
                let (mut result, mut square, mut left) = (self.context.constant(1.0), base, n.abs() as u32);
                while left > 0 {
                    if left & 1 == 1 {
                        result = self.binary('*', result, square)?;
                    }
                    left >>= 1;
                    if left > 0 {
                        square = sound(self.context.square(square))?;
                    }
                }
                let one = self.context.constant(1.0);
                if n < 0.0 { self.binary('/', one, result) } else { Ok(result) }
            }
            Ok(0.5) => sound(self.context.sqrt(base)),
            _ => {
                let logarithm = sound(self.context.ln(base))?;
                let product = self.binary('*', logarithm, exponent)?;
                sound(self.context.exp(product))
            }
        }
    }

    fn call(&mut self, name: &str, column: usize) -> Result<Node, ExpressionError> {
        self.at += 1;
        let mut placed = Vec::new();
        while !self.take_sign(')') {
            if !placed.is_empty() && !self.take_sign(',') {
                return Err(self.unexpected("`,`, `)` or an operator"));
            }
            let column = self.column();
            placed.push((self.expression(SUM)?, column));
        }
        let given = placed.len();
        let known = match NOISES.into_iter().find(|(noise, _)| *noise == name) {
            Some(noise) => {
                let value = noise_call::call(noise, &placed, self.context, &mut self.calls)?;
                value.ok_or_else(|| arity(name))
            }
            None => {
                let arguments: Vec<Node> = placed.into_iter().map(|(node, _)| node).collect();
                self.function(name, &arguments)?
            }
        };
        known.map_err(|wanted| match wanted {
            Some(wanted) => ExpressionError::Arguments { column, name: shortened(name), given, wanted },
            None => ExpressionError::Name { column, name: shortened(name) },
        })
    }

    /// What a function makes of its arguments; how many it takes, if not so many; nothing if there is no such function.
    fn function(
        &mut self,
        name: &str,
        arguments: &[Node],
    ) -> Result<Result<Node, Option<&'static str>>, ExpressionError> {
        let c = &mut *self.context;
        let node = match (name, arguments) {
            ("sqrt", &[a]) => c.sqrt(a),
            ("abs", &[a]) => c.abs(a),
            ("exp", &[a]) => c.exp(a),
            ("ln", &[a]) => c.ln(a),
            ("sin", &[a]) => c.sin(a),
            ("cos", &[a]) => c.cos(a),
            ("tan", &[a]) => c.tan(a),
            ("asin", &[a]) => c.asin(a),
            ("acos", &[a]) => c.acos(a),
            ("atan", &[a]) => c.atan(a),
            ("floor", &[a]) => c.floor(a),
            ("ceil", &[a]) => c.ceil(a),
            ("round", &[a]) => c.round(a),
            ("square", &[a]) => c.square(a),
            ("sign", &[a]) => c.compare(a, 0.0),
            ("cbrt", &[a]) => {
                // With the sign of the argument.
                let magnitude = sound(c.abs(a))?;
                let logarithm = sound(c.ln(magnitude))?;
                let third = sound(c.div(logarithm, 3.0))?;
                let root = sound(c.exp(third))?;
                let sign = sound(c.compare(a, 0.0))?;
                return self.binary('*', sign, root).map(Ok);
            }
            ("atan2", &[y, x]) => c.atan2(y, x),
            ("mod", &[a, b]) => return self.binary('%', a, b).map(Ok),
            ("pow", &[a, b]) => return self.power(a, b).map(Ok),
            ("clamp", &[v, low, high]) => {
                let raised = sound(c.max(v, low))?;
                c.min(raised, high)
            }
            ("mix", &[a, b, t]) => {
                let difference = self.binary('-', b, a)?;
                let part = self.binary('*', difference, t)?;
                return self.binary('+', a, part).map(Ok);
            }
            ("min" | "max", &[first, ref rest @ ..]) => {
                let mut node = first;
                for &next in rest {
                    node = sound(if name == "min" { c.min(node, next) } else { c.max(node, next) })?;
                }
                Ok(node)
            }
            ("length", &[_, ..]) => {
                let mut sum = self.context.constant(0.0);
                for &part in arguments {
                    let square = sound(self.context.square(part))?;
                    sum = self.binary('+', sum, square)?;
                }
                self.context.sqrt(sum)
            }
            _ => return Ok(Err(arity(name))),
        };
        sound(node).map(Ok)
    }
}

/// Every node is of this context, so the graph takes it.
fn sound<E>(node: Result<Node, E>) -> Result<Node, ExpressionError> {
    node.map_err(|_| ExpressionError::TooComplex)
}
