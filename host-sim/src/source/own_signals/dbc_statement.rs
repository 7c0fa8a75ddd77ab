//! One statement of a `.dbc` file: a message, or a signal of it.

/// A message, `BO_ 500 Name: 8 Sender`.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct MessageStatement<'t> {
    pub number: u32,
    pub name: &'t str,
}

/// A signal, `SG_ Name m2 : 7|16@0+ (0.01,0) [0|100] "km/h" Receiver`.
#[derive(Clone, Debug)]
pub(super) struct SignalStatement {
    pub role: Role,
    pub start_bit: u32,
    pub bits: u32,
    pub is_motorola: bool,
    pub is_signed: bool,
    pub factor: f64,
    pub offset: f64,
    pub range: (f64, f64),
    pub unit: String,
}

/// What a signal has to do with multiplexing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Role {
    /// It selects others.
    pub is_switch: bool,
    /// The number of the switch that selects it.
    pub selected_by: Option<u64>,
}

/// Reads what stands behind `BO_`.
pub(super) fn message(text: &str) -> Option<MessageStatement<'_>> {
    let (number, rest) = text.trim().split_once(char::is_whitespace)?;
    let (name, rest) = rest.split_once(':')?;
    let name = name.trim();
    let length = rest.split_whitespace().next()?;
    let is_message =
        !name.is_empty() && !name.contains(char::is_whitespace) && length.parse::<u32>().is_ok();
    is_message.then_some(MessageStatement {
        number: number.parse().ok()?,
        name,
    })
}

/// Returns the name of a signal, from what stands behind `SG_`.
pub(super) fn signal_name(text: &str) -> Option<&str> {
    let (head, _) = text.split_once(':').unwrap_or((text, ""));
    head.split_whitespace().next()
}

/// Reads what stands behind `SG_`. A receiver may be missing.
pub(super) fn signal(text: &str) -> Option<SignalStatement> {
    let (head, tail) = text.split_once(':')?;
    let mut words = head.split_whitespace().skip(1);
    let role = match (words.next(), words.next()) {
        (None, _) => Role::default(),
        (Some(word), None) => role(word)?,
        _ => return None,
    };
    let mut rest = Rest(tail);
    let start_bit = rest.before('|')?.parse().ok()?;
    let bits = rest.before('@')?.parse().ok()?;
    let order = rest.before('(')?;
    let (is_motorola, is_signed) = match order.replace(' ', "").as_str() {
        "0+" => (true, false),
        "0-" => (true, true),
        "1+" => (false, false),
        "1-" => (false, true),
        _ => return None,
    };
    let factor = number(rest.before(',')?)?;
    let offset = number(rest.before(')')?)?;
    rest.before('[').filter(|between| between.is_empty())?;
    let range = (number(rest.before('|')?)?, number(rest.before(']')?)?);
    rest.before('"').filter(|between| between.is_empty())?;
    Some(SignalStatement {
        role,
        start_bit,
        bits,
        is_motorola,
        is_signed,
        factor,
        offset,
        range,
        unit: rest.before('"')?.to_owned(),
    })
}

/// Reads `M`, `m2` or `m2M`.
fn role(word: &str) -> Option<Role> {
    let number = word.trim_end_matches('M').strip_prefix('m');
    let is_switch = word.ends_with('M');
    match number {
        Some(number) if word.len() <= number.len() + 2 => Some(Role {
            is_switch,
            selected_by: Some(number.parse().ok()?),
        }),
        None if word == "M" => Some(Role {
            is_switch,
            selected_by: None,
        }),
        _ => None,
    }
}

fn number(text: &str) -> Option<f64> {
    let is_digit = |c: char| c.is_ascii_digit() || matches!(c, '.' | '-' | '+' | 'e' | 'E');
    let number: f64 = text.chars().all(is_digit).then(|| text.parse().ok())??;
    number.is_finite().then_some(number)
}

/// The rest of a statement.
struct Rest<'t>(&'t str);

impl<'t> Rest<'t> {
    /// Takes what stands before a mark, and the mark.
    fn before(&mut self, mark: char) -> Option<&'t str> {
        let (before, rest) = self.0.split_once(mark)?;
        self.0 = rest;
        Some(before.trim())
    }
}
