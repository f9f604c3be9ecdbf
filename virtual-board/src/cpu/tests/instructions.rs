//! Tests edge cases of instructions. `virtual-board/reference` compares every encoding.

use super::*;

const N: u32 = 1 << 31;
const Z: u32 = 1 << 30;
const C: u32 = 1 << 29;
const V: u32 = 1 << 28;
const Q: u32 = 1 << 27;

/// Executes one instruction with R0 to R3 set. Returns R0 and the flags.
fn execute(code: &[u16], registers: [u32; 4], flags: u32) -> (u32, u32) {
    let mut bench = Bench::new(code);
    for (n, value) in registers.into_iter().enumerate() {
        bench.cpu.set_register(n, value);
    }
    bench.cpu.set_program_status(flags);
    bench.go(1);
    (bench.r(0), bench.cpu.program_status() & 0xF80F_0000)
}

#[test]
fn carries_and_overflows_at_the_edges() {
    const ADCS: &[u16] = &[0x4148];
    const SBCS: &[u16] = &[0x4188];
    const SUBS: &[u16] = &[0x1A40];
    for (code, a, b, flags, expected) in [
        (ADCS, u32::MAX, 0, C, (0, Z | C)),
        (ADCS, 0x7FFF_FFFF, 0, C, (0x8000_0000, N | V)),
        (ADCS, 0x8000_0000, 0x8000_0000, 0, (0, Z | C | V)),
        (SBCS, 0, 0, 0, (u32::MAX, N)),
        (SBCS, 0, u32::MAX, 0, (0, Z)),
        (SUBS, 0x8000_0000, 1, 0, (0x7FFF_FFFF, C | V)),
        (SUBS, 5, 5, 0, (0, Z | C)),
    ] {
        assert_eq!(
            execute(code, [a, b, 0, 0], flags),
            expected,
            "{a:#x} {b:#x}"
        );
    }
}

#[test]
fn shifts_by_32_and_more() {
    const LSLS: &[u16] = &[0x4088];
    const ASRS_32: &[u16] = &[0x1000];
    const RRXS: &[u16] = &[0xEA5F, 0x0031];
    assert_eq!(execute(LSLS, [1, 32, 0, 0], 0), (0, Z | C));
    assert_eq!(execute(LSLS, [1, 33, 0, 0], C), (0, Z));
    assert_eq!(execute(LSLS, [1, 256, 0, 0], C), (1, C));
    assert_eq!(execute(ASRS_32, [N, 0, 0, 0], 0), (u32::MAX, N | C));
    assert_eq!(execute(RRXS, [0, 1, 0, 0], C), (N, N | C));
}

#[test]
fn an_it_block_executes_the_matching_instructions_and_keeps_the_flags() {
    // ITTE EQ; MOVEQ R0, #1; MOVEQ R1, #2; MOVNE R2, #3
    let code = [0xBF06, 0x2001, 0x2102, 0x2203];
    for (flags, expected) in [(Z, [1, 2, 9]), (0, [9, 9, 3])] {
        let mut bench = Bench::new(&code);
        for n in 0..3 {
            bench.cpu.set_register(n, 9);
        }
        bench.cpu.set_program_status(flags);
        bench.go(4);
        assert_eq!([bench.r(0), bench.r(1), bench.r(2)], expected);
        assert_eq!(bench.cpu.program_status(), flags | 1 << 24);
        assert_eq!(bench.cpu.instructions(), 4, "skipped ones count");
    }
}

#[test]
fn saturation_sets_the_sticky_flag_and_nothing_else() {
    const SSAT_8: &[u16] = &[0xF301, 0x0007];
    const USAT_8: &[u16] = &[0xF381, 0x0008];
    const QADD: &[u16] = &[0xFA82, 0xF081];
    assert_eq!(execute(SSAT_8, [0, 127, 0, 0], 0), (127, 0));
    assert_eq!(execute(SSAT_8, [0, 128, 0, 0], N), (127, N | Q));
    assert_eq!(
        execute(SSAT_8, [0, -129_i32 as u32, 0, 0], 0),
        (-128_i32 as u32, Q)
    );
    assert_eq!(execute(USAT_8, [0, -1_i32 as u32, 0, 0], 0), (0, Q));
    assert_eq!(execute(USAT_8, [0, 256, 0, 0], 0), (255, Q));
    assert_eq!(execute(QADD, [0, 0x7FFF_FFFF, 1, 0], 0), (0x7FFF_FFFF, Q));
    assert_eq!(execute(QADD, [0, 1, 1, 0], Q), (2, Q), "it stays");
}

#[test]
fn parallel_sums_set_ge_for_each_lane_that_carried() {
    const SADD8: &[u16] = &[0xFA81, 0xF002];
    const UADD16: &[u16] = &[0xFA91, 0xF042];
    const SEL: &[u16] = &[0xFAA1, 0xF082];
    assert_eq!(
        execute(SADD8, [0, 0x7F80_01FF, 0x0180_FF00, 0], 0),
        (0x8000_00FF, 0b1010 << 16)
    );
    assert_eq!(
        execute(UADD16, [0, 0xFFFF_0001, 0x0001_0001, 0], 0),
        (0x0000_0002, 0b1100 << 16)
    );
    assert_eq!(
        execute(SEL, [0, 0x1111_1111, 0x2222_2222, 0], 0b0101 << 16).0,
        0x2211_2211
    );
}

#[test]
fn a_dual_product_overflows_only_in_the_sum() {
    const SMLAD: &[u16] = &[0xFB21, 0x3002];
    let largest = 0x8000_8000;
    assert_eq!(execute(SMLAD, [0, largest, largest, 0], 0), (N, Q));
    assert_eq!(
        execute(SMLAD, [0, largest, largest, u32::MAX], 0),
        (N - 1, 0)
    );
}

#[test]
fn the_largest_accumulated_product_fits_in_64_bits() {
    // UMAAL R0, R1, R2, R3
    let mut bench = Bench::new(&[0xFBE2, 0x0163]);
    for n in 0..4 {
        bench.cpu.set_register(n, u32::MAX);
    }
    bench.go(1);
    assert_eq!((bench.r(0), bench.r(1)), (u32::MAX, u32::MAX));
}

#[test]
fn a_store_is_exclusive_until_an_exception() {
    // LDREX R0, [R1]; NOP; STREX R2, R0, [R1]; STREX R3, R0, [R1]
    let code = [0xE851, 0x0F00, NOP, 0xE841, 0x0200, 0xE841, 0x0300];
    for (interrupted, expected) in [(false, [0, 1]), (true, [1, 1])] {
        let mut bench = Bench::new(&code);
        bench.cpu.set_register(1, Memories::SRAM);
        bench.enable(0, 0);
        bench.go(3);
        bench.cpu.signals.set_line(0, interrupted);
        bench.handler(16, &[0x2001, RETURN]);
        bench.go(1);
        bench.cpu.signals.set_line(0, false);
        bench.go(60);
        assert_eq!([bench.r(2), bench.r(3)], expected);
    }
}

#[test]
fn bit_band_aliases_are_single_bits() {
    // LDR R0, [R1]; STR R2, [R1]
    let mut bench = Bench::new(&[0x6808, 0x600A]);
    bench.board.memories.sram[8..12].copy_from_slice(&0xFFFF_FFDF_u32.to_le_bytes());
    bench.cpu.set_register(1, 0x2200_0000 + 8 * 32 + 5 * 4);
    bench.cpu.set_register(2, 0xFF);
    bench.go(4);
    assert_eq!(bench.r(0), 0);
    assert_eq!(bench.peek(Memories::SRAM + 8), u32::MAX);

    let mut bench = Bench::new(&[0x6808, 0x600A]);
    bench.board.device = 0xF1;
    bench.cpu.set_register(1, 0x4200_0000 + 4 * 4);
    bench.go(4);
    assert_eq!((bench.r(0), bench.board.device), (1, 0xE1));
}

#[test]
fn changed_flash_is_decoded_again() {
    let mut bench = Bench::new(&[0x2001, SELF_LOOP]);
    bench.go(10);
    bench.code(MAIN, &[0x2002]);
    bench.cpu.set_register(15, MAIN);
    bench.go(10);
    assert_eq!(bench.r(0), 2);
}

#[test]
fn code_in_ram_may_change_while_it_runs() {
    // RAM: ADDS R0, #1; BX LR. Then the same place: ADDS R0, #2.
    let mut bench = Bench::new(&[0x4788, 0x801A, 0x4788]);
    bench.board.memories.sram[..4].copy_from_slice(&[0x01, 0x30, 0x70, 0x47]);
    bench.cpu.set_register(1, Memories::SRAM | 1);
    bench.cpu.set_register(2, 0x3002);
    bench.cpu.set_register(3, Memories::SRAM);
    bench.go(40);
    assert_eq!(bench.r(0), 3);
}

#[test]
fn a_breakpoint_ends_a_run_once_each_time() {
    let mut bench = Bench::new(&[0x3001, 0x3001, 0xE7FC]);
    bench.go(1);
    bench.cpu.set_breakpoint(MAIN + 2, true);
    for count in [1, 3, 5] {
        assert_eq!(bench.run(1000), Stop::Breakpoint(MAIN + 2));
        assert_eq!(bench.r(0), count);
    }
    bench.cpu.set_breakpoint(MAIN + 2, false);
    bench.go(1000);
}

mod floats {
    use super::*;

    /// Executes one instruction with S0, S1 and S2 set. Returns S0 and FPSCR.
    fn execute(code: [u16; 2], registers: [f32; 3], status: u32) -> (f32, u32) {
        let mut bench = Bench::new(&code);
        bench.go(0);
        bench.cpu.in_float_context = true;
        for (n, value) in registers.into_iter().enumerate() {
            bench.cpu.set_float_register(n, value.to_bits());
        }
        bench.cpu.set_float_status(status);
        bench.go(1);
        let result = f32::from_bits(bench.cpu.float_register(0));
        (result, bench.cpu.float_status())
    }

    const ADD: [u16; 2] = [0xEE30, 0x0A20];
    const DIV: [u16; 2] = [0xEE80, 0x0A20];
    const MLA: [u16; 2] = [0xEE00, 0x0A81];
    const FMA: [u16; 2] = [0xEEA0, 0x0A81];
    const TO_INT: [u16; 2] = [0xEEBD, 0x0AC0];
    const INVALID: u32 = 1;
    const BY_ZERO: u32 = 2;
    const OVERFLOW: u32 = 4;
    const UNDERFLOW: u32 = 8;
    const INEXACT: u32 = 16;
    const UP: u32 = 1 << 22;
    const DOWN: u32 = 2 << 22;
    const TO_ZERO: u32 = 3 << 22;
    const FLUSH: u32 = 1 << 24;

    #[test]
    fn ties_round_to_even_and_directed_modes_round_in_their_direction() {
        let half_ulp = f32::EPSILON / 2.0;
        let next = 1.0 + f32::EPSILON;
        let sum = |a, status| execute(ADD, [a, half_ulp, 0.0], status).0;
        assert_eq!(sum(1.0, 0), 1.0);
        assert_eq!(sum(next, 0), next + f32::EPSILON);
        assert_eq!(sum(1.0, UP), next);
        assert_eq!(sum(next, DOWN), next);
        assert_eq!(sum(next, TO_ZERO), next);
        let tiny = execute(ADD, [1.0, f32::from_bits(1), 0.0], UP);
        assert_eq!(tiny, (next, UP | INEXACT));
        let exact = execute(ADD, [1.0, 2.0, 0.0], 0);
        assert_eq!(exact, (3.0, 0));
    }

    #[test]
    fn a_result_just_below_the_normal_numbers_has_underflowed() {
        // The exact quotient rounds up to the smallest normal number.
        let below = f32::from_bits(0x00FF_FFFF);
        let (result, status) = execute(DIV, [below, 2.0, 0.0], 0);
        assert_eq!(result, f32::MIN_POSITIVE);
        assert_eq!(status, UNDERFLOW | INEXACT);
        let sticky = execute(DIV, [below, 2.0, 0.0], INEXACT);
        assert_eq!(sticky.1, UNDERFLOW | INEXACT, "on the fast path too");
    }

    #[test]
    fn floating_point_exceptions_set_their_flags() {
        assert_eq!(execute(DIV, [1.0, 0.0, 0.0], 0), (f32::INFINITY, BY_ZERO));
        assert_eq!(execute(DIV, [0.0, 0.0, 0.0], 0).1, INVALID);
        assert_eq!(
            execute(ADD, [f32::MAX, f32::MAX, 0.0], 0),
            (f32::INFINITY, OVERFLOW | INEXACT)
        );
        assert_eq!(
            execute(ADD, [f32::MAX, f32::MAX, 0.0], TO_ZERO),
            (f32::MAX, TO_ZERO | OVERFLOW | INEXACT)
        );
        let denormal = f32::from_bits(5);
        assert_eq!(execute(ADD, [denormal, denormal, 0.0], 0).0.to_bits(), 10);
        assert_eq!(
            execute(ADD, [denormal, denormal, 0.0], FLUSH),
            (0.0, FLUSH | 1 << 7)
        );
    }

    #[test]
    fn a_sum_of_opposites_has_the_sign_of_the_rounding_mode() {
        let zero = |status| execute(ADD, [1.5, -1.5, 0.0], status).0.to_bits();
        assert_eq!(zero(0), 0);
        assert_eq!(zero(DOWN), 1 << 31);
    }

    #[test]
    fn a_chained_multiply_add_rounds_twice_and_a_fused_one_once() {
        let x = 1.0 + f32::EPSILON;
        // x² = 1 + 2ε + ε². The rounded product loses ε² before 1 + 2ε is subtracted.
        let registers = [-(1.0 + 2.0 * f32::EPSILON), x, x];
        let chained = [MLA[0], MLA[1]];
        assert_eq!(execute(chained, registers, 0).0, 0.0);
        assert_eq!(execute(FMA, registers, 0).0, f32::EPSILON * f32::EPSILON);
    }

    #[test]
    fn conversion_saturates_and_truncates() {
        let convert = |value| {
            let (result, status) = execute(TO_INT, [value, 0.0, 0.0], 0);
            (result.to_bits() as i32, status)
        };
        assert_eq!(convert(-2.75), (-2, INEXACT));
        assert_eq!(convert(3e9), (i32::MAX, INVALID));
        assert_eq!(convert(f32::NEG_INFINITY), (i32::MIN, INVALID));
        assert_eq!(convert(f32::NAN), (0, INVALID));
        assert_eq!(convert(-2_147_483_648.0), (i32::MIN, 0));
    }
}
