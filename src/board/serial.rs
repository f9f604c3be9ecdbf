//! What the serial port received, with what the line did to it.

use stm32f4xx_hal::pac::USART2;

/// A look at the receiver.
pub struct Received {
    /// The byte, unless its frame was broken.
    pub byte: Option<u8>,
    /// There was noise on the line; the receiver's majority of three samples has the byte all the same.
    pub noisy: bool,
    /// A byte was lost: its frame was broken, or nobody fetched it in time.
    pub lost: bool,
}

/// What there is to fetch; `None` if there is nothing. The driver's own function drops a byte that has noise on it, and
/// one that came before an overrun.
#[expect(unsafe_code, reason = "the interrupt owns the receiving half")]
pub fn receive() -> Option<Received> {
    // SAFETY: only the serial interrupt reads these two registers.
    let port = unsafe { USART2::steal() };
    let status = port.sr().read();
    if !status.rxne().bit() && !status.ore().bit() {
        return None;
    }
    // Read after the status, this clears all flags (RM0090, section 30.6.1).
    let byte = port.dr().read().dr().bits() as u8;
    let broken = status.fe().bit();
    Some(Received {
        byte: (status.rxne().bit() && !broken).then_some(byte),
        noisy: status.nf().bit(),
        lost: broken || status.ore().bit(),
    })
}
